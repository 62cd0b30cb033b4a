#include "runtime/plan/greedy.hpp"

#include <doctest/doctest.h>
#include <vector>

#include "tests/plan/plan_problem.hpp"
#include "tests/rules/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::plan;
using namespace gnomon::plan::test;
using gnomon::test::Random;

namespace {

struct Found {
    double value = 0.0, costMs = 0.0, cheapestMs = 0.0;
    std::vector<uint32_t> chosen;
};

Found solve(Greedy& greedy, const RandomProblem& problem, uint32_t tries = 16)
{
    greedy.begin(problem.methods, problem.parts);
    for (uint32_t light = 0; light < problem.lights; ++light) {
        greedy.addLight();
        for (const uint32_t m : problem.allowed[light]) {
            const size_t cell = size_t{light} * problem.methods + m;
            greedy.add({.ms = problem.costs[cell],
                        .price = problem.costs[cell],
                        .worth = problem.values[cell],
                        .method = static_cast<uint16_t>(m)});
        }
    }
    Found found;
    found.chosen.resize(problem.lights);
    found.cheapestMs = greedy.cheapestMs();
    greedy.solve(problem.budgetMs, 0, 0, tries, found.chosen);
    MethodSet used;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        const size_t cell = size_t{light} * problem.methods + found.chosen[light];
        found.value += problem.values[cell];
        found.costMs += problem.costs[cell];
        used.add(found.chosen[light]);
    }
    found.costMs += partsMs(problem.parts, used);
    return found;
}

} // namespace

TEST_CASE("greedy keeps every budget that can be kept, and loses a hundredth or two against the best plan")
{
    Random random(1);
    Greedy greedy;
    greedy.reserve(5, 12);
    for (const uint32_t parts : {0u, 4u}) {
        double lost = 0.0;
        uint32_t feasible = 0;
        for (int round = 0; round < 200; ++round) {
            const RandomProblem problem(random, 1 + random.below(5), parts ? 8 : 12, parts);
            const Found found = solve(greedy, problem);
            const Exhaustive all(problem, problem.budgetMs);
            CHECK(found.cheapestMs >= all.cheapest - 1e-12);
            if (parts == 0) CHECK(found.cheapestMs == doctest::Approx(all.cheapest).epsilon(1e-12));
            if (found.cheapestMs > problem.budgetMs) {
                CHECK(found.costMs == doctest::Approx(found.cheapestMs).epsilon(1e-12));
                continue;
            }
            REQUIRE(found.costMs <= problem.budgetMs * (1.0 + 1e-12));
            ++feasible;
            lost += 1.0 - found.value / all.best;
        }
        MESSAGE(parts, " parts: ", 100.0 * lost / feasible, " % lost in the mean of ", feasible);
        CHECK(lost / feasible < 0.02);
    }
}

TEST_CASE("a plan of one light is the best there is")
{
    Random random(2);
    Greedy greedy;
    greedy.reserve(1, 12);
    for (int round = 0; round < 500; ++round) {
        const RandomProblem problem(random, 1, 12);
        const Exhaustive all(problem, problem.budgetMs);
        const Found found = solve(greedy, problem);
        if (all.best >= 0.0) CHECK(found.value == doctest::Approx(all.best).epsilon(1e-12));
    }
}

TEST_CASE("the same problem gives the same plan without allocating, whatever was solved before")
{
    Random random(5);
    Greedy used;
    used.reserve(64, 12);
    for (int round = 0; round < 100; ++round) {
        const RandomProblem problem(random, 1 + random.below(64), 12, random.below(3));
        Greedy fresh;
        fresh.reserve(problem.lights, 12);
        const Found first = solve(fresh, problem);
        std::vector<uint32_t> chosen(problem.lights);
        CHECK(solve(used, problem).chosen == first.chosen);
        const size_t before = gnomon::rules::test::allocationCount();
        used.cheapestMs();
        used.solve(problem.budgetMs, 0, 0, 4, chosen);
        CHECK(gnomon::rules::test::allocationCount() == before);
    }
}

TEST_CASE("what is banned serves only where nothing else keeps the limit, and a light without options is left out")
{
    Greedy greedy;
    greedy.reserve(2, 2);
    const auto chosenWithin = [&](double limitMs) {
        greedy.begin(2, {});
        greedy.addLight();
        greedy.addLight();
        greedy.add({.ms = 3.0, .price = 3.0, .worth = 1.0, .method = 0});
        greedy.add({.ms = 1.0, .price = 1.0, .worth = 0.0, .method = 1, .banned = true});
        CHECK(greedy.cheapestMs() == 1.0);
        std::vector<uint32_t> chosen(2);
        greedy.solve(limitMs, 0, 0, 1, chosen);
        CHECK(chosen[0] == kNone);
        return chosen[1];
    };
    CHECK(chosenWithin(4.0) == 0);
    CHECK(chosenWithin(2.0) == 1);
    CHECK(chosenWithin(0.5) == 0); // no plan fits
}
