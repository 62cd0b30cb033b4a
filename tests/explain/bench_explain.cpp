/// What a record costs in a frame, and what a question costs when it is asked.
#include <benchmark/benchmark.h>

#include "explain/desk.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

DecisionRecord defaultRecord(Desk& desk)
{
    Situation situation;
    situation.fact(Fact::screenShare) = 0.4;
    situation.fact(Fact::lightRadius) = 0.05;
    situation.fact(Fact::receiverPlanarity) = std::numeric_limits<double>::quiet_NaN();
    return desk.decide(situation);
}

Desk defaultDesk()
{
    return Desk(*bindRules(rules::shippedRuleBase("default")));
}

/// The smallest change of every fact that flips the choice.
void nearMiss(benchmark::State& state)
{
    Desk desk = defaultDesk();
    const DecisionRecord record = defaultRecord(desk);
    for (auto _ : state)
        benchmark::DoNotOptimize(nearMisses(record, desk.engine()));
}
BENCHMARK(nearMiss)->Unit(benchmark::kMicrosecond);

void evaluateOnce(benchmark::State& state)
{
    Desk desk = defaultDesk();
    const DecisionRecord record = defaultRecord(desk);
    rules::Inference inference = desk.engine().makeInference();
    for (auto _ : state) {
        desk.engine().evaluate(record.facts, inference);
        benchmark::DoNotOptimize(inference.floorTruth);
    }
}
BENCHMARK(evaluateOnce);

void why(benchmark::State& state)
{
    Desk desk = defaultDesk();
    const DecisionRecord record = defaultRecord(desk);
    for (auto _ : state)
        benchmark::DoNotOptimize(explainWhy(record, desk.words()));
}
BENCHMARK(why)->Unit(benchmark::kMicrosecond);

/// One record into the ring, as every light pays for it in every frame.
void keep(benchmark::State& state)
{
    Desk desk = defaultDesk();
    DecisionRecord record = defaultRecord(desk);
    const auto lights = static_cast<std::uint32_t>(state.range(0));
    const auto rules = std::make_shared<const rules::Engine>(desk.engine());
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
    Desk desk = defaultDesk();
    const DecisionRecord record = defaultRecord(desk);
    rules::Inference inference = desk.engine().makeInference();
    desk.engine().evaluate(record.facts, inference);
    for (auto _ : state)
        benchmark::DoNotOptimize(strongestRules(desk.engine(), inference));
}
BENCHMARK(strongest);

} // namespace

BENCHMARK_MAIN();
