#include "demo/program/checks.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "demo/host/vulkan.hpp" // HostError
#include "demo/scene/scene_file.hpp"
#include "rules/engine/diagnostic.hpp"
#include "runtime/registry.hpp"

namespace gnomon::demo {
namespace {

bool contains(const std::vector<std::string>& names, std::string_view name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

const AlgorithmEntry* entryOf(std::string_view method)
{
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        if (method == algorithm.entry->name) return algorithm.entry;
    return nullptr;
}

/// Null: the method has none of this name.
const SettingSpec* settingOf(const AlgorithmEntry& entry, const std::string& name)
{
    for (const SettingSpec& setting : entry.settings)
        if (setting.name == name) return &setting;
    return nullptr;
}

std::string numberText(double value)
{
    std::string text;
    appendNumber(text, value);
    return text;
}

std::string ownersOf(const std::string& setting)
{
    std::string owners;
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        if (settingOf(*algorithm.entry, setting))
            owners += std::string(owners.empty() ? "" : ", ") + algorithm.entry->name;
    return owners;
}

HostError unknownSetting(const std::string& name, std::vector<std::string_view> known)
{
    std::ranges::sort(known);
    known.erase(std::unique(known.begin(), known.end()), known.end()); // several methods have it
    return HostError("--set: no method has a setting '" + name + "'" + rules::suggestion(name, known));
}

std::vector<std::string_view> builtInSettings()
{
    std::vector<std::string_view> names;
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        for (const SettingSpec& setting : algorithm.entry->settings)
            names.emplace_back(setting.name);
    return names;
}

/// \param methods empty: all of this build.
bool isSettingOf(const std::vector<std::string>& methods, const std::string& setting)
{
    return std::ranges::any_of(builtinRegistry().algorithms, [&](const BuiltinAlgorithm& algorithm) {
        return settingOf(*algorithm.entry, setting) && (methods.empty() || contains(methods, algorithm.entry->name));
    });
}

} // namespace

void requireScenes(const std::vector<std::string>& scenes)
{
    for (const std::string& scene : scenes)
        (void)valueOf(findScene(scene));
}

void requireMethods(const std::vector<std::string>& names, std::span<const char* const> besides)
{
    for (const std::string& name : names) {
        if (entryOf(name) || std::find(besides.begin(), besides.end(), name) != besides.end()) continue;
        std::vector<std::string_view> known(besides.begin(), besides.end());
        for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
            known.emplace_back(algorithm.entry->name);
        throw HostError("no method named '" + name + "' in this build" + rules::suggestion(name, known));
    }
}

bool isBuiltIn(std::string_view method)
{
    return entryOf(method) != nullptr;
}

std::vector<SettingChoice> requireChoices(const std::string& text, const std::vector<std::string>& methods,
                                          bool plugins)
{
    std::vector<SettingChoice> choices = parseChoices(text);
    for (const SettingChoice& choice : choices) {
        if (choice.name == "reasons")
            throw HostError("--set: 'reasons' puts codes in place of visibility; `gnomon-theses reasons` sets it where "
                            "it wants codes");
        if (plugins || isSettingOf(methods, choice.name)) continue;
        const std::string owners = ownersOf(choice.name);
        if (owners.empty()) throw unknownSetting(choice.name, builtInSettings());
        throw HostError("--set: no method that is asked for has a setting '" + choice.name + "'; it belongs to " +
                        owners);
    }
    return choices;
}

std::vector<SettingChoice> requireChoices(const RunOptions& options)
{
    const std::vector<std::string> methods = parseNames(options.method); // one, or none
    std::vector<SettingChoice> choices = requireChoices(options.settings, methods, !options.plugins.empty());
    requireRanges(choices, methods);
    return choices;
}

void requireOwners(const std::vector<SettingChoice>& choices, const std::vector<GnMethodInfo>& methods)
{
    std::vector<std::string_view> known;
    for (const GnMethodInfo& method : methods)
        for (uint32_t i = 0; i < method.settingCount; ++i)
            known.emplace_back(method.pSettings[i].pName);
    for (const SettingChoice& choice : choices)
        if (std::ranges::find(known, choice.name) == known.end()) throw unknownSetting(choice.name, known);
}

void requireSetting(const std::string& method, const std::string& setting)
{
    if (!isSettingOf({method}, setting))
        throw HostError("'" + method + "' has no setting '" + setting + "'; it belongs to " + ownersOf(setting));
}

void requireRanges(const std::vector<SettingChoice>& choices, const std::vector<std::string>& methods)
{
    for (const SettingChoice& choice : choices)
        for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms) {
            const std::string name = algorithm.entry->name;
            const SettingSpec* setting = settingOf(*algorithm.entry, choice.name);
            if (!setting || (!methods.empty() && !contains(methods, name))) continue;
            if (choice.value >= setting->minimum && choice.value <= setting->maximum) continue;
            if (setting->byCoverage && choice.value == 0.0) continue;
            throw HostError("--set: " + name + " takes '" + choice.name + "' from " + numberText(setting->minimum) +
                            " to " + numberText(setting->maximum) + (setting->byCoverage ? ", or 0" : "") + ", not " +
                            numberText(choice.value));
        }
}

void requireRecordable(const std::string& method)
{
    const AlgorithmEntry* entry = entryOf(method);
    if (entry && entry->roundTrips > 0)
        throw HostError("'" + method + "' needs the CPU between its passes and cannot be recorded: " +
                        "--recorded takes methods with 0 round trips (see `gnomon methods`)");
}

void requireWritable(const std::filesystem::path& file)
{
    if (file.empty()) return;
    std::error_code ignored; // what cannot be examined or removed again was not made here
    const bool existed = std::filesystem::exists(file, ignored);
    if (!std::ofstream(file, std::ios::app)) throw HostError(file.string() + ": cannot be written");
    if (!existed) std::filesystem::remove(file, ignored);
}

void requireGnuplot(const std::filesystem::path& picture)
{
    if (picture.empty() || std::system("gnuplot --version >/dev/null 2>&1") == 0) return; // NOLINT: fixed words
    throw HostError(picture.string() + ": gnuplot draws it, and cannot be run; is it installed?");
}

void requireWritableFolder(const std::filesystem::path& folder)
{
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw HostError(folder.string() + ": no such folder can be made");
    requireWritable(folder / ".gnomon_writable");
}

} // namespace gnomon::demo
