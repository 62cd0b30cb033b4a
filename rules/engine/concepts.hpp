#pragma once

/// Forward chaining: what rules conclude about the situation becomes a fact that further rules may ask for
/// (Rautenbach 2008, 5.2). A concept is settled once all rules that speak of it have fired, so none may depend on
/// itself, through however many rules.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rules/engine/compiled.hpp"
#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// The concepts of `base` in an order in which each stands behind those it is concluded from. Reports R08, with the
/// way round, where there is none. Names that are no concept are passed over.
std::optional<std::vector<uint32_t>> orderConcepts(const RuleBase& base, DiagnosticSink& sink);

/// Settles one concept: writes the truth of its terms from the strengths of the rules that assert them, joined like the
/// terms of an output (`aggregation`, priorities).
void settleConcept(const CompiledRules& compiled, const CompiledConcept& concept_, Options::Aggregation aggregation,
                   std::span<const Truth> strengths, std::span<Truth> memberships) noexcept;

} // namespace gnomon::rules
