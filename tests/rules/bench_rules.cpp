// How long evaluation takes, and how much faster than fuzzylite's own `benchmark` on the same rule base. Times drift
// with the machine; the ratios printed at the end come from one run.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include "bench_base.hpp"
#include "rules/engine/lint.hpp"
#include "runtime/base/number_text.hpp"
#include "rules/engine/export_fll.hpp"

using namespace gnomon;
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

void evaluation(benchmark::State& state)
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
    state.counters["a_light"] =
        benchmark::Counter(1, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void lintRules(benchmark::State& state)
{
    const Bench bench(64);
    for (auto _ : state)
        benchmark::DoNotOptimize(lint(*bench.engine));
}

BENCHMARK(evaluation);
BENCHMARK(lintRules)->Unit(benchmark::kMillisecond);

} // namespace

namespace {

/// Nanoseconds a call of `work`: the least of several rounds, since everything that disturbs only adds.
template <typename Work>
double leastTime(Work&& work)
{
    constexpr int kRounds = 30, kCalls = 2000;
    double least = 1e300;
    for (int round = 0; round < kRounds; ++round) {
        const auto begin = std::chrono::steady_clock::now();
        for (int i = 0; i < kCalls; ++i)
            work(i);
        const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
        least = std::min(least, spent.count() / kCalls);
    }
    return least;
}

/// Nanoseconds fuzzylite takes for one evaluation of the same base, by its own `benchmark` command; 0 where there is no
/// such program. The least of five runs.
double fuzzyliteTime(const Engine& engine)
{
    constexpr int kPoints = 2000;
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    const std::string name = (folder / ("gnomon_bench_" + std::to_string(getpid()))).string();
    std::ofstream(name + ".fll") << exportFll(engine, 100).text;
    {
        Random random;
        std::ofstream points(name + ".fld");
        for (int i = 0; i < kPoints; ++i) {
            for (int f = 0; f < 6; ++f)
                points << (f == 0 ? "" : " ") << shortestText(random.unit());
            points << '\n';
        }
    }
    const std::string command =
        "fuzzylite benchmark " + name + ".fll " + name + ".fld 5 " + name + ".tsv > /dev/null 2>&1";
    double least = 0.0;
    if (std::system(command.c_str()) == 0) {
        std::ifstream table(name + ".tsv");
        std::string heads, row;
        std::getline(table, heads);
        std::getline(table, row);
        // The row has fewer columns than the heads; its last five are the times of the runs, in ns for all points.
        for (int run = 0; run < 5 && !row.empty(); ++run) {
            const std::size_t tab = row.rfind('\t');
            const double time = parseNumber(std::string_view(row).substr(tab + 1)).value_or(0.0) / kPoints;
            least = run == 0 ? time : std::min(least, time);
            row.resize(tab == std::string::npos ? 0 : tab);
        }
    }
    for (const char* suffix : {".fll", ".fld", ".tsv"})
        std::filesystem::remove(name + suffix);
    return least;
}

void printRatios()
{
    const Bench bench(40);
    const std::vector<double> facts = randomColumns();
    Inference one = bench.engine->makeInference();
    const double time = leastTime([&](int i) {
        bench.engine->evaluate(std::span(facts).subspan(static_cast<std::size_t>(i) % kLights * 6, 6), one);
        benchmark::DoNotOptimize(one.outputs.data());
    });
    const double other = fuzzyliteTime(*bench.engine);
    std::printf("least time: %.0f ns a light\n", time);
    if (other == 0.0)
        std::printf("no program 'fuzzylite' here to compare with\n");
    else
        std::printf("fuzzylite benchmark %.0f ns: %.0f times as long\n", other, other / time);
}

} // namespace

int main(int argc, char** argv)
{
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    printRatios();
}
