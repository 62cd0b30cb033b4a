#pragma once
// A program (GNOMON_PROGRAM) from outside: a command line in, exit code, words and files out.

#include <doctest/doctest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "demo/io/image.hpp"
#include "own_folder.hpp"

namespace gnomon::demo {

struct Ran {
    int exitCode = -1;
    std::string output; ///< Both streams.
};

inline Ran run(const std::string& command)
{
    Ran ran;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::array<char, 4096> chunk{};
    for (size_t got = 0; (got = fread(chunk.data(), 1, chunk.size(), pipe)) > 0;)
        ran.output.append(chunk.data(), got);
    const int status = pclose(pipe);
    ran.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return ran;
}

inline Ran gnomonProgram(const std::string& arguments, const std::string& before = "")
{
    return run(before + " '" GNOMON_PROGRAM "' " + arguments);
}

inline std::vector<std::string> lines(const fs::path& file)
{
    std::ifstream stream(file);
    std::vector<std::string> out;
    for (std::string line; std::getline(stream, line);)
        out.push_back(line);
    return out;
}

inline size_t distinctColours(const Image8& image)
{
    std::set<std::array<uint8_t, 3>> colours;
    for (size_t i = 0; i + 2 < image.texels.size(); i += 3)
        colours.insert({image.texels[i], image.texels[i + 1], image.texels[i + 2]});
    return colours.size();
}

} // namespace gnomon::demo
