#pragma once
// What a command finds out before it measures anything: a misspelt name, or a file that cannot be written, must not
// cost minutes first. No device needed. Each check throws a HostError that names the input at fault.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "demo/program/setting_choices.hpp"

namespace gnomon::demo {

/// Each scene is a file or the name of a shipped one; what it holds is not looked at.
void requireScenes(const std::vector<std::string>& scenes);

/// Each of `names` is a method of this build, or one of `besides`: words that a command takes in its list as well.
void requireMethods(const std::vector<std::string>& names, std::span<const char* const> besides = {});

/// Whether the method is of this build; else a plug-in brought it.
bool isBuiltIn(std::string_view method);

/// What `--set` says: each setting is one of at least one of the methods, and none is `reasons`, which puts codes in
/// place of visibility. \param methods empty: all of this build. \param plugins some are loaded: a setting that is
/// unknown here may be theirs, see requireOwners().
std::vector<SettingChoice> requireChoices(const std::string& text, const std::vector<std::string>& methods,
                                          bool plugins = false);

/// The same of a run or a window, whose method, or all of this build where it names none, take the values.
std::vector<SettingChoice> requireChoices(const RunOptions& options);

/// Each setting is one of at least one of the methods, which a context has listed.
void requireOwners(const std::vector<SettingChoice>& choices, const std::vector<GnMethodInfo>& methods);

/// The method has the setting.
void requireSetting(const std::string& method, const std::string& setting);

/// Each value is one that each of the methods that have the setting takes. \param methods empty: all of this build.
void requireRanges(const std::vector<SettingChoice>& choices, const std::vector<std::string>& methods);

/// The method can be recorded: it needs no CPU between its passes. Unknown names pass; pinning them says why not.
void requireRecordable(const std::string& method);

/// The file can be written, whether it exists or not; afterwards it is as it was. An empty path passes.
void requireWritable(const std::filesystem::path& file);

/// Where a picture is wanted, `gnuplot` can be run.
void requireGnuplot(const std::filesystem::path& picture);

/// Makes the folder where it is missing, and sees that files can be written there.
void requireWritableFolder(const std::filesystem::path& folder);

} // namespace gnomon::demo
