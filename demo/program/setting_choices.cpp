#include "demo/program/setting_choices.hpp"

#include <algorithm>

namespace gnomon::demo {

std::vector<SettingChoice> parseChoices(const std::string& text)
{
    std::vector<SettingChoice> choices;
    for (const std::string& part : parseNames(text)) {
        const size_t equals = part.find('=');
        const std::optional<double> value = equals == std::string::npos
                                                ? std::nullopt
                                                : parseNumber(trimmed(std::string_view(part).substr(equals + 1)));
        if (!value) throw HostError("--set wants SETTING=NUMBER, not '" + part + "'");
        const std::string name(trimmed(std::string_view(part).substr(0, equals)));
        if (std::any_of(choices.begin(), choices.end(), [&](const SettingChoice& c) { return c.name == name; }))
            throw HostError("--set names '" + name + "' twice");
        choices.push_back({name, *value});
    }
    return choices;
}

} // namespace gnomon::demo
