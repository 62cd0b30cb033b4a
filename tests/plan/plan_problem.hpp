#pragma once
// Random plans, and the best of all there are.
#include <algorithm>
#include <limits>
#include <vector>

#include "runtime/plan/shared_part.hpp"
#include "tests/plan/random.hpp"

namespace gnomon::plan::test {

/// Costs log-uniform over two decades, values random but rising with cost on average, like methods are.
struct RandomProblem {
    uint32_t lights, methods;
    std::vector<double> values, costs; ///< lights x methods
    std::vector<SharedPart> parts;
    std::vector<MethodSet> allowed;
    double budgetMs = 0.0;

    RandomProblem(gnomon::test::Random& random, uint32_t lightCount, uint32_t methodCount, uint32_t partCount = 0)
        : lights(lightCount), methods(methodCount)
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
        for (uint32_t i = 0; i < partCount; ++i) {
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
        double cheap = 0.0, dear = 0.0;
        for (uint32_t light = 0; light < lights; ++light) {
            double low = std::numeric_limits<double>::infinity(), high = 0.0;
            for (const uint32_t m : allowed[light]) {
                low = std::min(low, costs[light * methods + m]);
                high = std::max(high, costs[light * methods + m]);
            }
            cheap += low, dear += high;
        }
        budgetMs = cheap + (dear - cheap) * random.between(-0.02, 0.6);
    }
};

/// Every plan there is, by counting up; skips a branch only once it is over the budget already.
struct Exhaustive {
    const RandomProblem& problem;
    double budgetMs;
    double best = -1.0; ///< Value of the best plan that fits.
    double cheapest = std::numeric_limits<double>::infinity();

    Exhaustive(const RandomProblem& p, double budget) : problem(p), budgetMs(budget) { visit(0, 0.0, 0.0, {}); }

    void visit(uint32_t light, double value, double cost, const MethodSet& used)
    {
        cheapest = light == problem.lights ? std::min(cheapest, cost) : cheapest;
        if (light == problem.lights) {
            if (cost <= budgetMs) best = std::max(best, value);
            return;
        }
        for (const uint32_t m : problem.allowed[light]) {
            const size_t i = size_t{light} * problem.methods + m;
            double next = cost + problem.costs[i];
            for (const SharedPart& part : problem.parts)
                if (part.methods.has(m) && !part.methods.meets(used)) next += part.ms;
            if (next > budgetMs && next >= cheapest) continue;
            visit(light + 1, value + problem.values[i], next, used | MethodSet{m});
        }
    }
};

} // namespace gnomon::plan::test
