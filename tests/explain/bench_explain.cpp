/// What a record costs in a frame, and what a question costs when it is asked.
#include <benchmark/benchmark.h>

#include "explain/selector_fixture.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

DecisionRecord defaultRecord(SelectorFixture& fixture)
{
    Situation situation;
    situation.fact(Fact::screenShare) = 0.4;
    situation.fact(Fact::lightRadius) = 0.05;
    situation.fact(Fact::receiverPlanarity) = std::numeric_limits<double>::quiet_NaN();
    return fixture.decide(situation);
}

SelectorFixture defaultFixture()
{
    return SelectorFixture(*bindRules(rules::shippedRuleBase("default")));
}

/// The smallest change of every fact that flips the choice.
void nearMiss(benchmark::State& state)
{
    SelectorFixture fixture = defaultFixture();
    const DecisionRecord record = defaultRecord(fixture);
    for (auto _ : state)
        benchmark::DoNotOptimize(nearMisses(record, fixture.engine()));
}
BENCHMARK(nearMiss)->Unit(benchmark::kMicrosecond);

void evaluateOnce(benchmark::State& state)
{
    SelectorFixture fixture = defaultFixture();
    const DecisionRecord record = defaultRecord(fixture);
    rules::Inference inference = fixture.engine().makeInference();
    for (auto _ : state) {
        fixture.engine().evaluate(record.facts, inference);
        benchmark::DoNotOptimize(inference.floorTruth);
    }
}
BENCHMARK(evaluateOnce);

void why(benchmark::State& state)
{
    SelectorFixture fixture = defaultFixture();
    const DecisionRecord record = defaultRecord(fixture);
    for (auto _ : state)
        benchmark::DoNotOptimize(explainWhy(record, fixture.words()));
}
BENCHMARK(why)->Unit(benchmark::kMicrosecond);

/// One record into the ring, as every light pays for it in every frame.
void keep(benchmark::State& state)
{
    SelectorFixture fixture = defaultFixture();
    DecisionRecord record = defaultRecord(fixture);
    const auto lights = static_cast<std::uint32_t>(state.range(0));
    const auto rules = std::make_shared<const rules::Engine>(fixture.engine());
    RecordRing ring;
    std::uint64_t frame = 0;
    for (auto _ : state) {
        ring.begin(++frame, lights, record.methods, rules);
        record.frame = frame;
        for (std::uint32_t i = 0; i < lights; ++i)
            ring.add(record, record.all());
    }
    state.SetItemsProcessed(state.iterations() * lights);
}
BENCHMARK(keep)->Arg(1)->Arg(16)->Arg(64);

void strongest(benchmark::State& state)
{
    SelectorFixture fixture = defaultFixture();
    const DecisionRecord record = defaultRecord(fixture);
    rules::Inference inference = fixture.engine().makeInference();
    fixture.engine().evaluate(record.facts, inference);
    for (auto _ : state)
        benchmark::DoNotOptimize(strongestRules(fixture.engine(), inference));
}
BENCHMARK(strongest);

} // namespace

BENCHMARK_MAIN();
