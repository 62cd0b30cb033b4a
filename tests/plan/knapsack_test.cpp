#include "runtime/plan/knapsack.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <limits>
#include <vector>

#include "tests/plan/random.hpp"
#include "tests/rules/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::plan;
using test::Random;

namespace {

struct Instance {
    std::vector<double> values, costs;
    std::vector<SharedPart> parts;
    std::vector<MethodSet> allowed;
    Problem problem;

    /// Costs log-uniform over two decades, values random but rising with cost on average, like methods are.
    Instance(Random& random, uint32_t lights, uint32_t methods, uint32_t withParts = 0)
    {
        for (uint32_t light = 0; light < lights; ++light) {
            MethodSet mask;
            for (uint32_t m = 0; m < methods; ++m) {
                const double octave = random.between(0.0, 6.6);
                costs.push_back(0.05 * (1u << static_cast<uint32_t>(octave)) *
                                (1.0 + octave - static_cast<uint32_t>(octave)));
                values.push_back(random.unit() * (0.3 + 0.1 * octave));
                if (random.unit() < 0.9) mask.add(m);
            }
            mask.add(random.below(methods));
            allowed.push_back(mask);
        }
        for (uint32_t i = 0; i < withParts; ++i) {
            const bool free = random.unit() < 0.1;
            // By one method, by two, by many: a copy of the depth is for all that ask on the CPU.
            MethodSet needed{random.below(methods)};
            if (i % 3 != 0) needed.add(random.below(methods));
            if (i % 3 == 2) {
                const uint32_t first = random.below(3);
                needed |= {first, first + 2, first + 4};
            }
            parts.push_back({free ? 0.0 : random.between(0.1, 1.5), needed});
        }
        problem = {lights, methods, values, costs, allowed, parts, 0.0};
        double cheap = 0.0, dear = 0.0;
        for (uint32_t light = 0; light < lights; ++light) {
            double low = std::numeric_limits<double>::infinity(), high = 0.0;
            for (uint32_t m = 0; m < methods; ++m)
                if (allowed[light].has(m)) {
                    low = std::min(low, costs[light * methods + m]);
                    high = std::max(high, costs[light * methods + m]);
                }
            cheap += low, dear += high;
        }
        problem.budgetMs = cheap + (dear - cheap) * random.between(-0.02, 0.6);
    }
    Instance(const Instance&) = delete;
};

/// Every plan there is, by counting up; skips a branch only once it is over the budget already.
struct Exhaustive {
    const Problem& problem;
    double budgetMs;
    double best = -1.0;
    double cheapest = std::numeric_limits<double>::infinity();

    Exhaustive(const Problem& p, double budget) : problem(p), budgetMs(budget) { visit(0, 0.0, 0.0, {}); }

    void visit(uint32_t light, double value, double cost, const MethodSet& used)
    {
        cheapest = light == problem.lights ? std::min(cheapest, cost) : cheapest;
        if (light == problem.lights) {
            if (cost <= budgetMs) best = std::max(best, value);
            return;
        }
        for (uint32_t m = 0; m < problem.methods; ++m) {
            if (!problem.allowed[light].has(m)) continue;
            const size_t i = size_t{light} * problem.methods + m;
            double next = cost + problem.costsMs[i];
            for (const SharedPart& part : problem.parts)
                if (part.methods.has(m) && !part.methods.meets(used)) next += part.ms;
            if (next > budgetMs && next >= cheapest) continue;
            visit(light + 1, value + problem.values[i], next, used | MethodSet{m});
        }
    }
};

double cheapestOf(const Problem& problem)
{
    double sum = 0.0;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        double low = std::numeric_limits<double>::infinity();
        for (uint32_t m = 0; m < problem.methods; ++m)
            if (problem.allowed[light].has(m)) low = std::min(low, problem.costsMs[light * problem.methods + m]);
        sum += low;
    }
    return sum;
}

} // namespace

TEST_CASE("the table is as good as every plan tried, for a budget smaller by its resolution")
{
    Random random(1);
    uint32_t equal = 0, feasible = 0;
    double worst = 0.0, sum = 0.0;
    for (int round = 0; round < 300; ++round) {
        const uint32_t lights = 1 + random.below(5);
        Instance instance(random, lights, 12);
        Knapsack knapsack;
        knapsack.reserve(lights, 12);
        std::vector<uint32_t> chosen(lights);
        const Solution found = knapsack.solve(instance.problem, chosen);
        const Exhaustive all(instance.problem, instance.problem.budgetMs);
        REQUIRE(found.fits == (all.best >= 0.0));
        if (!found.fits) {
            CHECK(found.costMs == doctest::Approx(all.cheapest).epsilon(1e-12));
            continue;
        }
        ++feasible;
        const double slack = instance.problem.budgetMs - cheapestOf(instance.problem);
        const Exhaustive less(instance.problem, instance.problem.budgetMs - slack * lights / kTableBins);
        CHECK(found.value >= less.best - 1e-12);
        CHECK(found.value <= all.best + 1e-12);
        const double loss = 1.0 - found.value / all.best;
        equal += loss < 1e-12;
        worst = std::max(worst, loss);
        sum += loss;
    }
    MESSAGE("against exhaustive: equal in ", equal, " of ", feasible, ", mean loss ", 100 * sum / feasible,
            " %, worst ", 100 * worst, " %");
    CHECK(equal > feasible * 95 / 100);
}

TEST_CASE("with parts that methods share the plan is the best of all in 19 of 20 cases, and never over the budget")
{
    Random random(2);
    double worst = 0.0, sum = 0.0;
    uint32_t feasible = 0, equal = 0;
    for (int round = 0; round < 150; ++round) {
        const uint32_t lights = 2 + random.below(4), methods = 8;
        Instance instance(random, lights, methods, 1 + random.below(6));
        Knapsack knapsack;
        knapsack.reserve(lights, methods);
        std::vector<uint32_t> chosen(lights);
        const Solution found = knapsack.solve(instance.problem, chosen);
        const Exhaustive all(instance.problem, instance.problem.budgetMs);
        CHECK(found.fits <= (all.best >= 0.0));
        CHECK(cheapestMs(instance.problem) == doctest::Approx(all.cheapest).epsilon(1e-12));
        if (all.best < 0.0) continue;
        REQUIRE(found.fits);
        ++feasible;
        CHECK(found.costMs <= instance.problem.budgetMs);
        CHECK(found.costMs == sumOf(instance.problem, chosen).costMs);
        const double loss = 1.0 - found.value / all.best;
        worst = std::max(worst, loss), sum += loss, equal += loss < 1e-9;
    }
    MESSAGE("shared parts: equal in ", equal, " of ", feasible, ", mean loss ", 100 * sum / feasible, " %, worst ",
            100 * worst, " %");
    CHECK(sum / feasible < 0.005);
    CHECK(equal > feasible * 95 / 100); // sets of parts are searched, not all tried: a rare plan is far off
}

TEST_CASE("no plan costs more than the budget if the cheapest one does not")
{
    Random random(3);
    Knapsack knapsack;
    knapsack.reserve(64, 12);
    std::vector<uint32_t> chosen(64);
    for (int round = 0; round < 2000; ++round) {
        Instance instance(random, 1 + random.below(64), 12);
        const Solution found = knapsack.solve(instance.problem, chosen);
        const double cheapest = cheapestOf(instance.problem);
        if (cheapest <= instance.problem.budgetMs * (1.0 - 1e-9)) REQUIRE(found.fits);
        if (!found.fits) CHECK(found.costMs == doctest::Approx(cheapest).epsilon(1e-12));
        CHECK((found.costMs <= instance.problem.budgetMs) == found.fits);
        for (uint32_t light = 0; light < instance.problem.lights; ++light)
            REQUIRE(instance.allowed[light].has(chosen[light]));
    }
}

TEST_CASE("greedy loses less the more lights there are")
{
    // Reference: the table with 16 384 bins, and greedy itself where that is better.
    Random random(4);
    double lastMean = 1.0;
    for (const uint32_t lights : {4u, 16u, 64u}) {
        const int rounds = lights == 64 ? 6 : 30;
        Knapsack fine(16384), knapsack;
        fine.reserve(lights, 12, lights);
        knapsack.reserve(lights, 12, lights);
        std::vector<uint32_t> chosen(lights);
        double sum = 0.0, worst = 0.0, tableSum = 0.0;
        for (int round = 0; round < rounds; ++round) {
            Instance instance(random, lights, 12);
            const Solution best = fine.solveTable(instance.problem, chosen);
            const Solution greedy = knapsack.solveGreedy(instance.problem, chosen);
            const Solution table = knapsack.solveTable(instance.problem, chosen);
            if (!best.fits) continue;
            const double top = std::max(best.value, greedy.value);
            sum += 1.0 - greedy.value / top;
            tableSum += 1.0 - table.value / top;
            worst = std::max(worst, 1.0 - greedy.value / top);
        }
        MESSAGE(lights, " lights: greedy mean ", 100 * sum / rounds, " %, worst ", 100 * worst,
                " %; table of 512 mean ", 100 * tableSum / rounds, " %");
        CHECK(sum / rounds <= lastMean);
        CHECK(sum / rounds < 0.02);
        lastMean = sum / rounds;
    }
}

TEST_CASE("the same problem gives the same plan without allocating, whatever was solved before")
{
    Random random(5);
    Knapsack used, fresh;
    used.reserve(64, 12);
    fresh.reserve(64, 12);
    std::vector<uint32_t> first(64), second(64);
    for (int round = 0; round < 200; ++round) {
        Instance instance(random, 1 + random.below(64), 12, random.below(3));
        const size_t before = rules::test::allocationCount();
        used.solve(instance.problem, first);
        CHECK(rules::test::allocationCount() == before);
        if (round % 20) continue;
        Knapsack clean;
        clean.reserve(instance.problem.lights, 12);
        clean.solve(instance.problem, second);
        CHECK(std::equal(first.begin(), first.begin() + instance.problem.lights, second.begin()));
    }
}

TEST_CASE("a light that may have nothing is left out")
{
    const std::vector<double> values{1.0, 2.0, 1.0, 2.0}, costs{1.0, 2.0, 1.0, 2.0};
    const std::vector<MethodSet> allowed{{}, {0, 1}};
    Knapsack knapsack;
    knapsack.reserve(2, 2);
    std::vector<uint32_t> chosen(2);
    const Solution found = knapsack.solve({2, 2, values, costs, allowed, {}, 2.5}, chosen);
    CHECK(found.fits);
    CHECK(chosen == std::vector<uint32_t>{kNone, 1});
    CHECK(found.costMs == 2.0);
}
