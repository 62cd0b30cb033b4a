// Rules over a recorded trace: what they would have said, from the facts.
#include <algorithm>
#include <limits>

#include "demo/host/vulkan.hpp" // HostError
#include "demo/program/rule_support.hpp"
#include "rules/engine/engine.hpp"

namespace gnomon::demo {

namespace {

/// Where each name of `wanted` stands among `names`; names.size() where it does not.
template <typename Wanted>
std::vector<size_t> columnsOf(const Wanted& wanted, const std::vector<std::string>& names)
{
    std::vector<size_t> columns;
    for (const auto& one : wanted)
        columns.push_back(static_cast<size_t>(std::find(names.begin(), names.end(), one.name) - names.begin()));
    return columns;
}

int16_t suitabilityOf(const rules::OutputState& output)
{
    if (output.vetoed) return kTraceVetoed;
    return output.hasOpinion ? static_cast<int16_t>(output.quantised) : int16_t{kTraceNoOpinion};
}

} // namespace

void applyRules(Trace& trace, const rules::RuleBase& base)
{
    const RuleVocabulary vocabulary = runtimeVocabulary();
    const rules::BindResult bound = rules::Engine::bind(base, vocabulary.view());
    if (report(bound.diagnostics) || !bound.engine) throw HostError(base.name + ": these rules do not bind");
    const std::vector<size_t> factColumns = columnsOf(vocabulary.facts, trace.facts);
    const std::vector<size_t> methodColumns = columnsOf(vocabulary.outputs, trace.methods);
    rules::Inference inference = bound.engine->makeInference();
    std::vector<double> facts(vocabulary.facts.size());
    for (size_t cell = 0; cell < trace.lightStates.size(); ++cell) {
        TraceLight& light = trace.lightStates[cell];
        if (!light.present) continue;
        for (size_t i = 0; i < facts.size(); ++i)
            facts[i] = factColumns[i] < trace.facts.size()
                           ? double{trace.factValues[cell * trace.facts.size() + factColumns[i]]}
                           : std::numeric_limits<double>::quiet_NaN();
        bound.engine->evaluate(facts, inference);
        light.floor = !base.policy.floor.when.empty() && inference.floorTruth >= base.policy.floor.atStrength;
        light.minimumQuality = light.floor ? static_cast<float>(base.policy.floor.minimumQuality) : 0.0f;
        for (size_t i = 0; i < methodColumns.size(); ++i) {
            if (methodColumns[i] == trace.methods.size()) continue;
            TraceMethod& method = trace.measures[cell * trace.methods.size() + methodColumns[i]];
            if (method.suitability != kTraceUnable) method.suitability = suitabilityOf(inference.outputs[i]);
        }
    }
}

} // namespace gnomon::demo
