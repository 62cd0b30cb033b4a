// Fuzz entry point for rule bases: any text is read, bound, linted, evaluated and explained.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <vector>

#include "rules/engine/explain.hpp"
#include "rules/engine/lint.hpp"
#include "rules/yaml/rule_base_reader.hpp"

using namespace gnomon::rules;

namespace {

/// What must hold whatever the text was. A violation ends the process, which is how a fuzzer learns of it.
void require(bool holds)
{
    if (!holds) std::abort();
}

void evaluateEverywhere(const Engine& engine)
{
    Inference inference = engine.makeInference();
    const double facts[] = {0.0, 1e300, -1e300, std::numeric_limits<double>::quiet_NaN(), 45.0, 0.5};
    for (const double fact : facts) {
        engine.evaluate(std::vector<double>(engine.facts().size(), fact), inference);
        for (const OutputState& output : inference.outputs) {
            require(output.hasOpinion == (output.quantised >= 0));
            require(output.quantised <= kSuitabilitySteps);
        }
        for (const RuleState& rule : inference.rules)
            require(rule.strength >= 0.0 && rule.strength <= 1.0);
        require(!explain(engine, inference).empty() || engine.outputs().empty());
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size)
{
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const ParseResult parsed = parseRuleBase(text, "fuzz.yaml");
    require(parsed.base.has_value() || !parsed.diagnostics.empty());
    if (!parsed.base) return 0;
    // A host that knows whatever the text names, so that binding rarely ends the journey early.
    std::vector<FactInfo> facts;
    for (const Variable& variable : parsed.base->variables)
        facts.push_back({variable.name, ""});
    std::vector<OutputInfo> outputs = {{"shadow_map", {"softPenumbra"}}, {"stencil_volume", {}}, {"pcf_hybrid", {}}};
    const BindResult bound =
        Engine::bind(*parsed.base, {.facts = facts, .outputs = outputs, .absent = {}, .traits = {}});
    require(bound.engine.has_value() || !bound.diagnostics.empty());
    if (!bound.engine) return 0;
    evaluateEverywhere(*bound.engine);
    if (parsed.base->rules.size() <= 64) // keeps one input within milliseconds
        lint(*bound.engine);
    return 0;
}
