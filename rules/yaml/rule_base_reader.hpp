#pragma once

/// Rule bases from YAML text. The format is described in rules/README.md.

#include <optional>
#include <string_view>
#include <vector>

#include "rules/engine/diagnostic.hpp"
#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

struct ParseResult {
    std::optional<RuleBase> base; ///< Empty when there was an error: a base is never half read.
    /// Where sentences alone were at fault: the base without them, so that a linter may look for more. Not to be used.
    std::optional<RuleBase> remains;
    std::vector<Diagnostic> diagnostics;

    explicit operator bool() const noexcept { return base.has_value(); }
};

/// Reads one rule base. `fileName` appears in diagnostics only; nothing is opened. All errors of a text are reported at
/// once as far as possible, those of its presets too. Safe on any input; no exception but std::bad_alloc leaves it.
/// \param preset a name under `presets`: the base as that changes it; empty: as it stands. An unknown one is an error
///     that lists those there are.
ParseResult parseRuleBase(std::string_view text, std::string_view fileName, std::string_view preset = {});

} // namespace gnomon::rules
