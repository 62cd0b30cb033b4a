// `gnomon replay`: what the plan, every fixed method and a naive table make of a recorded trace. No device needed.
#include <algorithm>
#include <cstdio>
#include <optional>

#include "demo/host/vulkan.hpp" // HostError
#include "demo/io/file.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/rule_support.hpp"
#include "demo/program/session.hpp"
#include "demo/replay/budget.hpp"
#include "demo/replay/replay.hpp"
#include "demo/replay/resample.hpp"

namespace gnomon::demo {

namespace {

Trace loadTrace(const std::string& file)
{
    Outcome<Trace> trace = readTrace(valueOf(readText(file)));
    if (!trace) throw HostError(file + ": " + trace.error());
    return std::move(*trace);
}

cost::KnowledgeBase loadKnowledgeBase(const std::string& nameOrPath)
{
    const std::filesystem::path file = valueOf(findKnowledge(nameOrPath));
    cost::KnowledgeResult knowledge = cost::parseKnowledge(valueOf(readText(file)));
    if (!knowledge.base) throw HostError(file.string() + ": " + knowledge.error);
    return std::move(*knowledge.base);
}

void describe(const Trace& trace)
{
    const auto [least, most] = std::minmax_element(trace.budgetsMs.begin(), trace.budgetsMs.end());
    std::printf("%u frames of %.3f s, %u lights, %zu methods, budget %.3g to %.3g ms\n", trace.frames,
                double{trace.frameSeconds}, trace.lights, trace.methods.size(), double{*least}, double{*most});
}

void printSequence(const Trace& trace, const ReplayMetrics& plan)
{
    for (size_t i = 0; i < plan.sequence.size(); ++i)
        std::printf("%s%s", i == 0 ? "all lights in turn: " : ", ", trace.methods[plan.sequence[i]].c_str());
    if (!plan.sequence.empty()) std::printf("\n");
}

} // namespace

int replayCommand(const ReplayCommandOptions& options)
{
    Trace trace = loadTrace(options.trace);
    if (trace.frames == 0) throw HostError(options.trace + ": a trace without frames");
    if (options.rate > 0.0) trace = resample(trace, options.rate);
    const rules::RuleBase base = parseRules(options.rules);
    if (!options.rules.empty()) applyRulesAloud(trace, base);
    if (!options.budget.empty()) expect(setBudgets(trace, options.budget));

    ReplayOptions replay{.policy = base.policy, .allocation = base.options.allocation, .seed = options.seed};
    std::optional<cost::KnowledgeBase> knowledge;
    std::optional<Trace> calibration;
    if (!options.calibration.empty()) calibration = loadTrace(options.calibration);
    if (!calibration && options.knowledge != "none") {
        knowledge = options.knowledge.empty() ? cost::shippedKnowledge() : loadKnowledgeBase(options.knowledge);
        replay.knowledge = knowledge->nearestTo({}, "software");
    }
    describe(trace);
    const std::vector<ReplayMetrics> onMinima = compare(trace, replay, calibration ? &*calibration : nullptr);
    std::printf("\non the minima of the sweeps\n%s", toTable(onMinima).c_str());
    printSequence(trace, onMinima.front());
    replay.rawTimes = true;
    std::printf("\non raw times, drawn from the spread of the sweeps with seed %llu\n%s",
                static_cast<unsigned long long>(options.seed),
                toTable(compare(trace, replay, calibration ? &*calibration : nullptr)).c_str());
    return 0;
}

} // namespace gnomon::demo
