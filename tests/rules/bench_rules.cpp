// How long evaluation takes, and how much faster than fuzzylite's own `benchmark` on the same rule base. Times drift
// with the machine; the ratios printed at the end come from one run.

#include <benchmark/benchmark.h>

#include "bench_base.hpp"
#include "rules/engine/batch.hpp"
#include "rules/engine/lint.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

/// xorshift64*: the same rule base everywhere.
class Random {
public:
    uint32_t operator()(uint32_t below) { return static_cast<uint32_t>((next() >> 11) % below); }
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

private:
    uint64_t next()
    {
        state_ ^= state_ >> 12;
        state_ ^= state_ << 25;
        state_ ^= state_ >> 27;
        return state_ * 0x2545f4914f6cdd1du;
    }
    uint64_t state_ = 0x9e3779b97f4a7c15u;
};

struct Bench {
    std::vector<FactInfo> facts;
    std::vector<OutputInfo> outputs = benchOutputs();
    std::optional<Engine> engine;

    explicit Bench(std::size_t rules)
    {
        Random random;
        RuleBase base = benchBase(random, rules);
        for (const Variable& v : base.variables)
            facts.push_back({v.name, ""});
        engine = Engine::bind(base, {.facts = facts, .outputs = outputs, .absent = {}, .traits = {}}).engine;
    }
};

constexpr uint32_t kLights = 64;

std::vector<double> randomColumns()
{
    Random random;
    std::vector<double> values(6 * kLights);
    for (double& value : values)
        value = random.unit();
    return values;
}

void scalar(benchmark::State& state)
{
    const Bench bench(40);
    Inference inference = bench.engine->makeInference();
    const std::vector<double> rows = randomColumns();
    std::size_t at = 0;
    for (auto _ : state) {
        bench.engine->evaluate(std::span(rows).subspan(at * 6, 6), inference);
        benchmark::DoNotOptimize(inference.outputs.data());
        at = (at + 1) % kLights;
    }
    state.counters["ns_a_light"] =
        benchmark::Counter(1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void batch(benchmark::State& state, InstructionSet set, bool unknown)
{
    if (!isSupported(set)) {
        state.SkipWithError("not on this processor");
        return;
    }
    const Bench bench(40);
    const BatchEngine engine(*bench.engine, set);
    BatchInference inference = engine.makeInference(kLights);
    std::vector<double> facts = randomColumns();
    for (uint32_t i = 0; unknown && i < kLights; ++i)
        facts[i] = std::numeric_limits<double>::quiet_NaN();
    for (auto _ : state) {
        engine.evaluateBatch(facts, kLights, inference);
        benchmark::DoNotOptimize(inference.quantised.data());
    }
    state.counters["ns_a_light"] =
        benchmark::Counter(kLights * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void lintRules(benchmark::State& state)
{
    const Bench bench(64);
    for (auto _ : state)
        benchmark::DoNotOptimize(lint(*bench.engine));
}

BENCHMARK(scalar);
BENCHMARK_CAPTURE(batch, baseline, InstructionSet::Baseline, false);
BENCHMARK_CAPTURE(batch, avx2, InstructionSet::Avx2, false);
BENCHMARK_CAPTURE(batch, avx512, InstructionSet::Avx512, false);
BENCHMARK_CAPTURE(batch, best_with_an_unknown_fact, bestInstructionSet(), true);
BENCHMARK(lintRules)->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
