#pragma once

/// Presets: named changes of a rule base, written in the base itself under `presets`. A preset has keys of the base.
/// Maps are changed key by key; rules replace those with their id, or are added; `without` names rules to leave out.

#include <string>
#include <string_view>
#include <vector>

#include "rules/engine/rule_base.hpp"
#include "rules/yaml/document.hpp"

namespace gnomon::rules {

/// The presets of a base in the order of the text. Reports what is malformed about them; their content is read with the
/// base that they change.
std::vector<Preset> readPresets(const yaml::Node& root, DiagnosticSink& sink);

/// The base as the preset changes it, without `presets`. Reports names of rules that the base does not have.
/// \pre readPresets() found the name and reported nothing.
yaml::Node withPreset(const yaml::Node& root, std::string_view name, DiagnosticSink& sink);

/// Adds what is said of the base with a preset and not of the base without it.
void addNew(std::vector<Diagnostic>& findings, std::vector<Diagnostic> more, std::string_view preset);

/// "there is no preset 'lo'; there are low, medium".
std::string noPreset(std::string_view name, const RuleBase& base);

} // namespace gnomon::rules
