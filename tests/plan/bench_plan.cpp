/// Time of one decision per light: admission, knapsack, hysteresis, reasons. Facts drift as in a slow walk, so that
/// plans are kept, repaired and improved in turn. Percentiles are over single decisions.

#include <algorithm>
#include <benchmark/benchmark.h>
#include <chrono>
#include <vector>

#include "runtime/cost/cost_model.hpp"
#include "runtime/plan/plan.hpp"
#include "tests/plan/random.hpp"

using namespace gnomon;
using namespace gnomon::plan;

namespace {

constexpr uint32_t kMethods = 12;

void decision(benchmark::State& state)
{
    const auto lights = static_cast<uint32_t>(state.range(0));
    test::Random random(1);
    std::vector<LightMemory> memories(lights);
    std::vector<LightRequest> requests;
    std::vector<Candidate> candidates;
    for (uint32_t i = 0; i < lights; ++i) {
        requests.push_back({.memory = &memories[i], .importance = random.between(0.5, 1.0)});
        for (uint32_t m = 0; m < kMethods; ++m) {
            const double ms = random.between(0.05, 2.0);
            candidates.push_back({.suitability = static_cast<int32_t>(1000 + random.below(1000) + 1000 * ms),
                                  .quality = static_cast<float>(random.between(0.5, 1.0)),
                                  .ms = ms,
                                  .sigmaMs = 0.1 * ms});
        }
    }
    PlanStep plan;
    plan.reserve(lights, kMethods);
    PlanInput input{.lights = requests, .candidates = candidates, .methods = kMethods, .budgetMs = 0.6 * lights};
    std::vector<double> times;
    times.reserve(1 << 20);
    uint64_t changed = 0;
    for (auto _ : state) {
        for (uint32_t i = 0; i < lights; ++i) { // one in twelve candidates drifts a little
            Candidate& candidate = candidates[i * kMethods + random.below(kMethods)];
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
    std::sort(times.begin(), times.end());
    const double perLight = 1e9 / lights;
    state.counters["p50_ns_per_light"] = times[times.size() / 2] * perLight;
    state.counters["p99_ns_per_light"] = times[times.size() * 99 / 100] * perLight;
    state.counters["changed"] = static_cast<double>(changed) / static_cast<double>(times.size());
}
BENCHMARK(decision)->Arg(4)->Arg(8)->Arg(16)->Arg(64)->UseManualTime();

/// What the cost model takes to foretell every method of every light: GPU times of update and resolve, two map sizes.
void foretelling(benchmark::State& state)
{
    const auto lights = static_cast<uint32_t>(state.range(0));
    test::Random random(2);
    cost::CostModel model;
    model.resize(kMethods, lights);
    const auto workloadFor = [&](uint32_t method) {
        return cost::Workload{.pixels = random.between(1e4, 9e5),
                              .casterTriangles = random.between(1e3, 1e5),
                              .mapTexels = method % 2 ? 1048576.0 : 0.0,
                              .viewPixels = 921600.0};
    };
    for (uint32_t method = 0; method < kMethods; ++method)
        for (int i = 0; i < 40; ++i)
            for (const cost::Pass pass : {cost::Pass::update, cost::Pass::resolve})
                model.calibrate(method, pass, cost::Processor::gpu, workloadFor(method), random.between(0.5, 5.0));
    model.finishCalibration(true);
    std::vector<cost::Workload> workloads;
    for (uint32_t i = 0; i < lights; ++i)
        workloads.push_back(workloadFor(0));
    std::vector<double> times;
    times.reserve(1 << 20);
    for (auto _ : state) {
        for (cost::Workload& workload : workloads) // every light's facts drift
            workload.pixels *= random.between(0.99, 1.0101);
        const auto start = std::chrono::steady_clock::now();
        double sum = 0.0;
        for (uint32_t i = 0; i < lights; ++i)
            for (uint32_t method = 0; method < kMethods; ++method) {
                cost::Workload workload = workloads[i];
                workload.mapTexels = method % 2 ? 1048576.0 : 0.0;
                sum += model.predict(i, method, workload, false).ms;
            }
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        benchmark::DoNotOptimize(sum);
        state.SetIterationTime(took.count());
        if (times.size() < times.capacity()) times.push_back(took.count());
    }
    std::sort(times.begin(), times.end());
    const double perLight = 1e9 / lights;
    state.counters["p50_ns_per_light"] = times[times.size() / 2] * perLight;
    state.counters["p99_ns_per_light"] = times[times.size() * 99 / 100] * perLight;
}
BENCHMARK(foretelling)->Arg(64)->UseManualTime();

} // namespace

BENCHMARK_MAIN();
