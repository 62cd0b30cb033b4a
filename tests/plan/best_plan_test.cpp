// The best plan of a frame, as replays measure policies by it.
#include "demo/replay/best_plan.hpp"

#include <doctest/doctest.h>
#include <vector>

#include "tests/plan/plan_problem.hpp"

using namespace gnomon;
using namespace gnomon::demo;
using plan::test::Exhaustive;
using plan::test::RandomProblem;
using test::Random;

namespace {

PlanProblem borrowed(const RandomProblem& problem)
{
    return {problem.lights, problem.methods, problem.values, problem.costs, problem.allowed, problem.budgetMs};
}

} // namespace

TEST_CASE("the best plan is as good as every plan tried, for a budget smaller by the table's resolution")
{
    Random random(1);
    uint32_t equal = 0, feasible = 0;
    for (int round = 0; round < 300; ++round) {
        const uint32_t lights = 1 + random.below(5);
        const RandomProblem problem(random, lights, 12);
        BestPlans plans(lights, 12);
        std::vector<uint32_t> chosen(lights);
        const BestPlan found = plans.find(borrowed(problem), chosen);
        const Exhaustive all(problem, problem.budgetMs);
        REQUIRE(found.fits == (all.best >= 0.0));
        if (!found.fits) {
            CHECK(found.costMs == doctest::Approx(all.cheapest).epsilon(1e-12));
            continue;
        }
        ++feasible;
        CHECK(found.costMs <= problem.budgetMs);
        const double slack = problem.budgetMs - all.cheapest;
        const Exhaustive less(problem, problem.budgetMs - slack * lights / 512.0);
        CHECK(found.value >= less.best - 1e-12);
        CHECK(found.value <= all.best + 1e-12);
        equal += found.value > all.best - 1e-12;
    }
    CHECK(equal > feasible * 95 / 100);
}

TEST_CASE("a light that may have nothing is left out of the best plan")
{
    const std::vector<double> values{1.0, 2.0, 1.0, 2.0}, costs{1.0, 2.0, 1.0, 2.0};
    const std::vector<MethodSet> allowed{{}, {0, 1}};
    BestPlans plans(2, 2);
    std::vector<uint32_t> chosen(2);
    const BestPlan found = plans.find({2, 2, values, costs, allowed, 2.5}, chosen);
    CHECK(found.fits);
    CHECK(chosen == std::vector<uint32_t>{plan::kNone, 1});
    CHECK(found.costMs == 2.0);
}
