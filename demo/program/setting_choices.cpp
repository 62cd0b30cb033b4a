#include "demo/program/setting_choices.hpp"

#include <algorithm>
#include <cstdio>

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

GnMethodInfo infoOf(const ShadowHost& shadows, const std::string& method)
{
    for (const GnMethodInfo& info : shadows.methods())
        if (method == info.pName) return info;
    throw HostError("no method '" + method + "'");
}

bool hasSetting(const GnMethodInfo& method, std::string_view name)
{
    return std::any_of(method.pSettings, method.pSettings + method.settingCount,
                       [&](const GnSettingInfo& setting) { return setting.pName == name; });
}

std::string textOf(const GnMethodInfo& method, const std::vector<SettingChoice>& choices)
{
    std::string text;
    for (const SettingChoice& choice : choices) {
        if (!hasSetting(method, choice.name)) continue;
        text += ' ' + choice.name + '=';
        appendNumber(text, choice.value);
    }
    return text;
}

void setChoices(ShadowHost& shadows, const std::string& method, const std::vector<SettingChoice>& choices)
{
    if (choices.empty()) return;
    for (const GnMethodInfo& info : shadows.methods())
        for (const SettingChoice& choice : choices)
            if ((method.empty() || method == info.pName) && hasSetting(info, choice.name))
                expect(shadows.set(info.pName, choice.name, choice.value));
    for (const std::string& message : shadows.takeMessages())
        std::fprintf(stderr, "gnomon: %s\n", message.c_str());
}

} // namespace gnomon::demo
