#include "rules/engine/sample_points.hpp"

#include <algorithm>
#include <cmath>

#include "rules/engine/cells.hpp"
#include "runtime/base/number_text.hpp"

namespace gnomon::rules {
namespace {

/// Root above 1 of x^(d+1) = x + 1, by Newton's method with multiplications only: no library function, so the same bits
/// everywhere.
double recurrenceRoot(std::size_t dimensions)
{
    double x = 2.0;
    for (int i = 0; i < 128; ++i) {
        double power = 1.0; // x^d
        for (std::size_t d = 0; d < dimensions; ++d)
            power *= x;
        x -= (power * x - x - 1.0) / (static_cast<double>(dimensions + 1) * power - 1.0);
    }
    return x;
}

/// Calls `place(variable, point, share)` with shares in [0, 1) that fill the unit cube evenly.
template <typename Place>
void fillEvenly(std::size_t dimensions, uint32_t count, Place&& place)
{
    const double step = 1.0 / recurrenceRoot(std::max<std::size_t>(dimensions, 1));
    double increment = step;
    for (uint32_t v = 0; v < dimensions; ++v) {
        double share = 0.5;
        for (uint32_t i = 0; i < count; ++i) {
            share += increment;
            share -= share >= 1.0 ? 1.0 : 0.0;
            place(v, i, share);
        }
        increment *= step;
    }
}

} // namespace

SamplePoints evenPoints(const Engine& engine, uint32_t count)
{
    SamplePoints points(engine, count);
    const auto& variables = engine.base().variables;
    fillEvenly(variables.size(), count, [&](uint32_t v, uint32_t i, double share) {
        const Variable& variable = variables[v];
        double x = variable.low + share * (variable.high - variable.low);
        if (variable.isCount()) { // every whole number has the same share
            const double first = std::ceil(variable.low), last = std::floor(variable.high);
            x = std::min(last, first + std::floor(share * (last - first + 1.0)));
        }
        points.at(engine.compiled().variables[v].fact, i) = x;
    });
    return points;
}

SamplePoints cellPoints(const Engine& engine, uint32_t count)
{
    SamplePoints points(engine, count);
    std::vector<std::vector<Cell>> cells;
    for (const Variable& variable : engine.base().variables)
        cells.push_back(cellsOf(variable));
    fillEvenly(cells.size(), count, [&](uint32_t v, uint32_t i, double share) {
        if (cells[v].empty()) return; // a count without a whole number
        const auto cell = static_cast<std::size_t>(share * static_cast<double>(cells[v].size()));
        points.at(engine.compiled().variables[v].fact, i) = cells[v][cell].inside;
    });
    return points;
}

Opinions opinionsAt(const Engine& engine, const SamplePoints& points)
{
    Opinions all{.outputCount = engine.outputs().size(), .outputs = {}, .floorTruth = {}};
    all.outputs.reserve(all.outputCount * points.count);
    all.floorTruth.reserve(points.count);
    Inference inference = engine.makeInference();
    for (uint32_t i = 0; i < points.count; ++i) {
        engine.evaluate(std::span(points.facts).subspan(i * points.factCount, points.factCount), inference);
        all.outputs.insert(all.outputs.end(), inference.outputs.begin(), inference.outputs.end());
        all.floorTruth.push_back(inference.floorTruth);
    }
    return all;
}

Winner winnerAmong(std::span<const uint32_t> outputs, const Opinions& all, uint32_t point) noexcept
{
    Winner winner;
    int32_t best = -1;
    for (const uint32_t output : outputs) {
        const OutputState& state = all.at(output, point);
        if (!state.hasOpinion || state.vetoed) continue;
        if (state.quantised > best) {
            best = state.quantised;
            winner = {output, kNoRule};
        } else if (state.quantised == best && winner.runnerUp == kNoRule) {
            winner.runnerUp = output;
        }
    }
    return winner;
}

std::string pointText(const Engine& engine, const SamplePoints& points, uint32_t point)
{
    std::string text;
    for (const CompiledVariable& variable : engine.compiled().variables) {
        const double x = points.at(variable.fact, point);
        text += (text.empty() ? "" : ", ") + engine.facts()[variable.fact].name + " = ";
        text += x == std::floor(x) ? shortestText(x) : fixedText(x, 3);
    }
    return text;
}

} // namespace gnomon::rules
