/// Time of one decision per light: admission, knapsack, hysteresis, reasons. Facts drift as in a slow walk, so that
/// plans are kept, repaired and improved in turn. Percentiles are over single decisions.

#include <algorithm>
#include <array>
#include <benchmark/benchmark.h>
#include <chrono>
#include <vector>

#include "rules/engine/engine.hpp"
#include "runtime/cost/cost_model.hpp"
#include "runtime/plan/plan.hpp"
#include "tests/plan/random.hpp"
#include "tests/rules/bench_base.hpp"

using namespace gnomon;
using namespace gnomon::plan;

namespace {

void countPercentiles(benchmark::State& state, std::vector<double>& seconds, uint32_t lights)
{
    std::sort(seconds.begin(), seconds.end());
    const double perLight = 1e9 / lights;
    state.counters["p50_ns_per_light"] = seconds[seconds.size() / 2] * perLight;
    state.counters["p99_ns_per_light"] = seconds[seconds.size() * 99 / 100] * perLight;
}

void decision(benchmark::State& state)
{
    const auto lights = static_cast<uint32_t>(state.range(0));
    const auto methods = static_cast<uint32_t>(state.range(2));
    test::Random random(1);
    std::vector<LightMemory> memories(lights);
    std::vector<LightRequest> requests;
    std::vector<Candidate> candidates;
    for (uint32_t i = 0; i < lights; ++i) {
        requests.push_back({.memory = &memories[i], .importance = random.between(0.5, 1.0)});
        for (uint32_t m = 0; m < methods; ++m) {
            const double ms = random.between(0.05, 2.0);
            candidates.push_back({.suitability = static_cast<int32_t>(1000 + random.below(1000) + 1000 * ms),
                                  .quality = static_cast<float>(random.between(0.5, 1.0)),
                                  .ms = ms,
                                  .sigmaMs = 0.1 * ms});
        }
    }
    PlanStep plan;
    plan.reserve(lights, methods);
    // A copy of the depth, bounds of receivers, a stencil buffer, strips of it: families of methods need them.
    constexpr SharedPart kParts[] = {
        {1.0, {0, 1, 2, 3, 4, 5}}, {0.7, {0, 1}}, {0.8, {6, 7, 8, 9, 10}}, {0.5, {6, 7, 8}}};
    const std::span parts = std::span<const SharedPart>(kParts).first(static_cast<size_t>(state.range(1)));
    PlanInput input{
        .lights = requests, .candidates = candidates, .parts = parts, .methods = methods, .budgetMs = 0.6 * lights};
    std::vector<double> times;
    times.reserve(1 << 20);
    uint64_t changed = 0;
    for (auto _ : state) {
        for (uint32_t i = 0; i < lights; ++i) { // one in twelve candidates drifts a little
            Candidate& candidate = candidates[i * methods + random.below(methods)];
            candidate.ms *= random.between(0.99, 1.0101);
            candidate.suitability =
                std::clamp(candidate.suitability + static_cast<int32_t>(random.below(41)) - 20, 0, 4096);
        }
        const auto start = std::chrono::steady_clock::now();
        const PlanReport report = plan.step(input);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        ++input.frame;
        changed += report.switches > 0;
        state.SetIterationTime(took.count());
        if (times.size() < times.capacity()) times.push_back(took.count());
    }
    countPercentiles(state, times, lights);
    state.counters["changed"] = static_cast<double>(changed) / static_cast<double>(times.size());
}
BENCHMARK(decision)
    ->ArgNames({"lights", "parts", "methods"})
    ->ArgsProduct({{4, 64}, {0, 4}, {12, 21, 64}})
    ->UseManualTime();

cost::Workload workloadOf(test::Random& random, uint32_t method)
{
    return {.pixels = random.between(1e4, 9e5),
            .casterTriangles = random.between(1e3, 1e5),
            .mapTexels = method % 2 ? 1048576.0 : 0.0,
            .viewPixels = 921600.0};
}

/// A model that knows so many methods.
cost::CostModel calibratedModel(uint32_t lights, uint32_t methods, test::Random& random)
{
    cost::CostModel model;
    model.resize(methods, lights);
    for (uint32_t method = 0; method < methods; ++method) {
        std::array<cost::TrackCost, cost::kTracks> tracks;
        tracks[cost::trackOf(cost::Pass::update, cost::Processor::gpu)] = {
            .ms = {0.05, random.between(0.1, 1.0), 0.0, 0.3, 0.3}, .octaves = 0.3, .samples = 40};
        tracks[cost::trackOf(cost::Pass::resolve, cost::Processor::gpu)] = {
            .ms = {0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, random.between(0.5, 5.0)}, .octaves = 0.3, .samples = 40};
        model.teach(method, tracks, 0.0);
    }
    return model;
}

/// What the cost model takes to predict every method of every light: GPU times of update and resolve, two map sizes.
void predicting(benchmark::State& state)
{
    const auto lights = static_cast<uint32_t>(state.range(0));
    const auto methods = static_cast<uint32_t>(state.range(1));
    test::Random random(2);
    cost::CostModel model = calibratedModel(lights, methods, random);
    std::vector<cost::Workload> workloads;
    for (uint32_t i = 0; i < lights; ++i)
        workloads.push_back(workloadOf(random, 0));
    std::vector<double> times;
    times.reserve(1 << 20);
    for (auto _ : state) {
        for (cost::Workload& workload : workloads) // every light's facts drift
            workload.pixels *= random.between(0.99, 1.0101);
        const auto start = std::chrono::steady_clock::now();
        double sum = 0.0;
        for (uint32_t i = 0; i < lights; ++i)
            for (uint32_t method = 0; method < methods; ++method) {
                cost::Workload workload = workloads[i];
                workload.mapTexels = method % 2 ? 1048576.0 : 0.0;
                sum += model.predict(i, method, workload, false).ms;
            }
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        benchmark::DoNotOptimize(sum);
        state.SetIterationTime(took.count());
        if (times.size() < times.capacity()) times.push_back(took.count());
    }
    countPercentiles(state, times, lights);
}
BENCHMARK(predicting)->ArgNames({"lights", "methods"})->ArgsProduct({{64}, {12, 21, 64}})->UseManualTime();

/// From facts to methods: the rules asked about every light, as Selector does (6 facts, 40 rules, an output a method),
/// the times of an eighth of the lights predicted again, as FramePlan does, and the plan of all.
void wholeDecision(benchmark::State& state)
{
    const auto lights = static_cast<uint32_t>(state.range(0));
    const auto methods = static_cast<uint32_t>(state.range(1));
    test::Random random(3);
    const std::vector<rules::OutputInfo> outputs = rules::test::benchOutputs(static_cast<int>(methods));
    rules::RuleBase base = rules::test::benchBase([&](uint32_t below) { return random.below(below); }, 40, methods);
    std::vector<rules::FactInfo> names;
    for (const rules::Variable& variable : base.variables)
        names.push_back({variable.name, ""});
    const rules::Engine engine =
        std::move(*rules::Engine::bind(base, {.facts = names, .outputs = outputs, .absent = {}, .traits = {}}).engine);
    rules::Inference opinions = engine.makeInference();
    cost::CostModel model = calibratedModel(lights, methods, random);
    std::vector<cost::Workload> workloads;
    std::vector<double> facts(lights * names.size());
    for (double& fact : facts)
        fact = random.between(0.0, 1.0);
    std::vector<LightMemory> memories(lights);
    std::vector<LightRequest> requests;
    for (uint32_t i = 0; i < lights; ++i) {
        requests.push_back({.memory = &memories[i], .importance = random.between(0.5, 1.0)});
        workloads.push_back(workloadOf(random, 0));
    }
    std::vector<Candidate> candidates(lights * methods);
    for (Candidate& candidate : candidates)
        candidate.quality = static_cast<float>(random.between(0.5, 1.0));
    PlanStep plan;
    plan.reserve(lights, methods);
    PlanInput input{.lights = requests, .candidates = candidates, .methods = methods, .budgetMs = 1.2 * lights};
    std::vector<double> times;
    times.reserve(1 << 20);
    for (auto _ : state) {
        for (double& fact : facts)
            fact = std::clamp(fact + random.between(-0.002, 0.002), 0.0, 1.0);
        for (cost::Workload& workload : workloads)
            workload.pixels *= random.between(0.999, 1.00101);
        const auto start = std::chrono::steady_clock::now();
        for (uint32_t i = 0; i < lights; ++i) {
            engine.evaluate(std::span(facts).subspan(i * names.size(), names.size()), opinions);
            const bool due = input.frame == 0 || (input.frame + i) % 8 == 0;
            for (uint32_t m = 0; m < methods; ++m) {
                Candidate& candidate = candidates[i * methods + m];
                candidate.suitability = opinions.outputs[m].quantised;
                if (!due) continue;
                cost::Workload workload = workloads[i];
                workload.mapTexels = m % 2 ? 1048576.0 : 0.0;
                const cost::Prediction prediction = model.predict(i, m, workload, false);
                candidate.ms = prediction.sureMs();
                candidate.sigmaMs = prediction.measured ? prediction.sigmaMs : 0.0;
            }
        }
        plan.step(input);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        ++input.frame;
        state.SetIterationTime(took.count());
        if (times.size() < times.capacity()) times.push_back(took.count());
    }
    countPercentiles(state, times, lights);
}
BENCHMARK(wholeDecision)->ArgNames({"lights", "methods"})->ArgsProduct({{64}, {12, 21, 64}})->UseManualTime();

} // namespace

BENCHMARK_MAIN();
