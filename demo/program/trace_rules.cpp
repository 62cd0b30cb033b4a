// Rules over a recorded trace: what they would have said, from the facts.
#include <algorithm>
#include <cstdio>
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

bool serves(const rules::OutputInfo& method, const TraceLight& light)
{
    const char* kind = light.directional ? "directional" : light.point ? "point" : "spot";
    return std::find(method.traits.begin(), method.traits.end(), kind) != method.traits.end();
}

/// The best suitability among the methods of a trace that can serve the light; -1 where none has one.
int16_t bestHeld(const Trace& trace, size_t cell)
{
    int16_t best = kTraceNoOpinion;
    for (size_t m = 0; m < trace.methods.size(); ++m)
        best = std::max(best, trace.measures[cell * trace.methods.size() + m].suitability);
    return best;
}

} // namespace

std::vector<std::string> applyRules(Trace& trace, const rules::RuleBase& base)
{
    const RuleVocabulary vocabulary = runtimeVocabulary();
    const rules::BindResult bound = rules::Engine::bind(base, vocabulary.view());
    if (report(bound.diagnostics) || !bound.engine) throw HostError(base.name + ": these rules do not bind");
    const std::vector<size_t> factColumns = columnsOf(vocabulary.facts, trace.facts);
    const std::vector<size_t> methodColumns = columnsOf(vocabulary.outputs, trace.methods);
    rules::Inference inference = bound.engine->makeInference();
    std::vector<double> facts(vocabulary.facts.size());
    std::vector<uint8_t> missed(methodColumns.size());
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
        const int16_t best = bestHeld(trace, cell);
        for (size_t i = 0; i < methodColumns.size(); ++i)
            if (methodColumns[i] == trace.methods.size() && serves(vocabulary.outputs[i], light) &&
                suitabilityOf(inference.outputs[i]) > best)
                missed[i] = 1;
    }
    std::vector<std::string> names;
    for (size_t i = 0; i < missed.size(); ++i)
        if (missed[i]) names.push_back(vocabulary.outputs[i].name);
    return names;
}

void applyRulesAloud(Trace& trace, const rules::RuleBase& base)
{
    const std::vector<std::string> missing = applyRules(trace, base);
    if (missing.empty()) return;
    std::string names;
    for (const std::string& name : missing)
        names += (names.empty() ? "" : ", ") + name;
    std::fprintf(stderr, "warning: %s would choose what the trace does not hold: %s\n", base.name.c_str(),
                 names.c_str());
}

} // namespace gnomon::demo
