#pragma once
// Settings given on the command line.

#include <string>
#include <vector>

#include "demo/io/number.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

struct SettingChoice {
    std::string name;
    double value = 0.0;
};

/// "filter=3,resolution=512"; throws HostError naming the part that is none, or a setting given twice.
std::vector<SettingChoice> parseChoices(const std::string& text);

/// As the context has the method now; its pointers live as long. Throws HostError where there is none.
GnMethodInfo infoOf(const ShadowHost& shadows, const std::string& method);

bool hasSetting(const GnMethodInfo& method, std::string_view name);

/// " filter=3 mips=1": those that the method has.
std::string textOf(const GnMethodInfo& method, const std::vector<SettingChoice>& choices);

/// Sets what a method has of them, and prints what gnomon says to that. \param method empty: all methods.
void setChoices(ShadowHost& shadows, const std::string& method, const std::vector<SettingChoice>& choices);

} // namespace gnomon::demo
