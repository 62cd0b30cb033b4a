#include <algorithm>
#include <string>
#include <vector>

#include "rules/engine/cells.hpp"
#include "rules/engine/lint_checks.hpp"
#include "rules/engine/sample_points.hpp"
#include "runtime/base/number_text.hpp"

/// L09. Walks along the axis of the promise, corner by corner and twice between corners, from many points of the other
/// facts.

namespace gnomon::rules {
namespace {

constexpr uint32_t kWalks = 256;

std::vector<double> stopsOf(const Variable& variable)
{
    std::vector<double> stops;
    for (const Cell& cell : cellsOf(variable)) {
        if (cell.low == cell.high || variable.isCount())
            stops.push_back(cell.inside);
        else
            for (const double share : {0.125, 0.5, 0.875})
                stops.push_back(cell.low + share * (cell.high - cell.low));
    }
    return stops;
}

/// How far suitability moves while one and the same term is concluded more or less strongly, in steps of 1/4096: a
/// trapezoid cut low has its centre of gravity elsewhere than the whole. That is no change of opinion.
int32_t wobbleOf(const Engine& engine)
{
    constexpr int32_t kRounding = 1;
    const std::size_t terms = engine.base().suitability.terms.size();
    int32_t widest = 0;
    for (std::size_t t = 0; t < terms; ++t) {
        std::vector<double> strengths(terms, 0.0);
        int32_t lowest = kSuitabilitySteps, highest = 0;
        for (int tenth = 0; tenth <= 10; ++tenth) {
            strengths[t] = tenth == 0 ? 0.001 : 0.1 * tenth;
            const int32_t now = engine.quantisedOf(engine.centroidOf(strengths));
            lowest = std::min(lowest, now);
            highest = std::max(highest, now);
        }
        widest = std::max(widest, highest - lowest);
    }
    return widest + kRounding;
}

std::string suitabilityText(const Opinions& all, uint32_t output, uint32_t point)
{
    return fixedText(all.at(output, point).suitability, 2);
}

} // namespace

void checkMonotony(const Engine& engine, DiagnosticSink& sink)
{
    const CompiledRules& compiled = engine.compiled();
    const int32_t tolerance = wobbleOf(engine);
    for (std::size_t p = 0; p < compiled.monotony.size(); ++p) {
        const Monotony& promise = engine.base().monotony[p];
        const uint32_t fact = compiled.variables[compiled.monotony[p].variable].fact;
        std::vector<double> stops = stopsOf(engine.base().variables[compiled.monotony[p].variable]);
        if (!promise.ascending) std::reverse(stops.begin(), stops.end());
        const auto steps = static_cast<uint32_t>(stops.size());
        const SamplePoints starts = cellPoints(engine, kWalks);
        SamplePoints walk(engine, steps);
        Opinions all{};
        const auto isBroken = [&](uint32_t output) {
            int32_t extreme = -1; // lowest so far where it must not rise, highest where it must not fall
            uint32_t extremeAt = 0;
            for (uint32_t i = 0; i < steps; ++i) {
                const int32_t now = all.at(output, i).quantised;
                if (now < 0) continue;
                const int32_t wrong = promise.raises ? now - extreme : extreme - now;
                if (extreme >= 0 && wrong > tolerance) {
                    sink.warning("L09", promise.variableAt,
                                 inQuotes(promise.sentence) + " does not hold: " + engine.outputs()[output].name +
                                     " goes from " + suitabilityText(all, output, extremeAt) + " to " +
                                     suitabilityText(all, output, i) + " between " + promise.variable + " = " +
                                     shortestText(stops[extremeAt]) + " and " + shortestText(stops[i]) + " where " +
                                     pointText(engine, walk, i));
                    return true;
                }
                if (extreme < 0 || wrong < 0) {
                    extreme = now;
                    extremeAt = i;
                }
            }
            return false;
        };
        for (uint32_t start = 0; start < kWalks; ++start) {
            for (uint32_t f = 0; f < engine.facts().size(); ++f) {
                for (uint32_t i = 0; i < steps; ++i)
                    walk.at(f, i) = f == fact ? stops[i] : starts.at(f, start);
            }
            all = opinionsAt(engine, walk);
            const auto& outputs = compiled.monotony[p].outputs;
            if (std::any_of(outputs.begin(), outputs.end(), isBroken)) break; // one example a promise
        }
    }
}

} // namespace gnomon::rules
