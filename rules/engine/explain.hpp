#pragma once

/// Why the rules think what they think, as text. Built on demand from an evaluation; evaluate() itself writes none.

#include <cstdint>
#include <string>
#include <vector>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

struct ExplainOptions {
    uint32_t rulesPerOutput = 4; ///< Strongest first.
    bool because = false;        ///< Adds the `because` of each rule on a line of its own.
};

/// One line per output, best first, vetoed ones and those without an opinion last:
///
///     shadow_map          0.84   rule T3: dynamicLights few 1.00, viewerDistance far 1.00
///     stencil_volume      0.16   rule T3 (avoided): dynamicLights few 1.00, viewerDistance far 1.00
///     cube_map      no opinion
///
/// The conclusion is named where it is not the highest term of suitability, and what a rule yields to. Unknown facts
/// are listed at the end.
std::string explain(const Engine& engine, const Inference& inference, const ExplainOptions& options = {});

/// What fired one rule: "rule S1: lightRadius narrow 0.25, frameBudget tight 0.10*, weight 0.8". Every clause with its
/// truth, except alternatives under `or` that were false; '*' marks the limiting one where there are several.
std::string explainRule(const Engine& engine, const Inference& inference, uint32_t rule);

/// Rules that fired and conclude something about an output, first what counts most beside rules of a higher priority,
/// then by falling priority, then as written; vetoes are none of them.
std::vector<uint32_t> rulesBehind(const Engine& engine, const Inference& inference, uint32_t output);

/// ", yields to EX, counts 0.10" where a rule of a higher priority that says otherwise about the output leaves less of
/// a rule than it fired with; else empty.
std::string yieldText(const Engine& engine, const Inference& inference, uint32_t rule, uint32_t output);

/// Per rule the most that it counts as for any output; what it fired with where it speaks of none.
std::vector<double> countedStrengths(const Engine& engine, const Inference& inference);

/// explainRule() with what the rule concludes about the output, where that is not the highest term of suitability:
/// "rule T3 (avoided): dynamicLights few 1.00".
std::string explainRuleFor(const Engine& engine, const Inference& inference, uint32_t rule, uint32_t output);

/// Among the written rules that did not fire, the first whose conclusion about the output is the highest; kNoRule if
/// none speaks of it.
uint32_t silentRuleFor(const Engine& engine, const Inference& inference, uint32_t output);

/// "viewerDistance 12.4 m: near 0.59, far 0.41": the raw fact and its two largest memberships. Empty for a fact that
/// the base has no variable for.
std::string explainFact(const Engine& engine, const Inference& inference, uint32_t fact);

/// One line without a line break for logs: the strongest rule behind an output, or why there is none.
std::string reasonFor(const Engine& engine, const Inference& inference, uint32_t output);

} // namespace gnomon::rules
