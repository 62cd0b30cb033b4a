#pragma once
// What the programs' command lines share beyond CLI11.

#include <CLI/CLI.hpp>

namespace gnomon::demo {

inline constexpr const char* kSceneHelp = "path of a scene file, or the name of a shipped one (see `gnomon scenes`)";

/// A number in [low, high]. CLI::Range lets NaN pass.
CLI::Validator numberIn(double low, double high);

/// A number above 0, also as a float, and at most `high`: where 0 would be taken for something else.
CLI::Validator numberAbove0To(double high);

/// CLI11 takes -1 for the largest number of 64 bits.
CLI::Validator notNegative();

/// Runs the command that the arguments name. Prints what is wrong with them, and what a command throws.
/// \param exitCode what the commands' callbacks set. \return the program's exit code.
int runCommandLine(CLI::App& app, int argc, char** argv, const int& exitCode);

} // namespace gnomon::demo
