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

} // namespace gnomon::demo
