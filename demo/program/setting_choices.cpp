#include "demo/program/setting_choices.hpp"

namespace gnomon::demo {

std::vector<SettingChoice> parseChoices(const std::string& text)
{
    std::vector<SettingChoice> choices;
    for (const std::string& part : parseNames(text)) {
        const size_t equals = part.find('=');
        const std::optional<double> value =
            equals == std::string::npos ? std::nullopt : parseNumber(std::string_view(part).substr(equals + 1));
        if (!value) throw HostError("--set wants SETTING=NUMBER, not '" + part + "'");
        choices.push_back({part.substr(0, equals), *value});
    }
    return choices;
}

} // namespace gnomon::demo
