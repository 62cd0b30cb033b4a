#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "rules/engine/lint.hpp"
#include "rules/engine/sample_points.hpp"
#include "runtime/base/number_text.hpp"

/// L08: how much of a recorded trace lies so close to a boundary between two decisions that noise alone crosses it.

namespace gnomon::rules {
namespace {

/// Standard deviation of one fact's measurements, from the steps between frames: their median, since most frames move a
/// fact little, scaled as for a normal distribution (1 / 0.6745) and for a difference of two (1 / sqrt 2).
double estimatedNoise(const FactTrace& trace, std::size_t factCount, std::size_t fact)
{
    constexpr double kScale = 1.0 / (0.6744897501960817 * 1.4142135623730951);
    std::vector<double> steps;
    for (std::size_t row = 1; (row + 1) * factCount <= trace.rows.size(); ++row) {
        if (!trace.frames.empty() && trace.frames[row] != trace.frames[row - 1] + 1) continue;
        const double step = trace.rows[row * factCount + fact] - trace.rows[(row - 1) * factCount + fact];
        if (!std::isnan(step)) steps.push_back(std::abs(step));
    }
    if (steps.empty()) return 0.0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle * kScale;
}

SamplePoints toPoints(const Engine& engine, const FactTrace& trace)
{
    SamplePoints points(engine, static_cast<uint32_t>(trace.rows.size() / engine.facts().size()));
    std::copy_n(trace.rows.begin(), points.facts.size(), points.facts.begin());
    return points;
}

/// The winners of all frames, kind by kind.
std::vector<uint32_t> decisionsAt(const Engine& engine, const SamplePoints& points)
{
    const Opinions all = opinionsAt(engine, points);
    std::vector<uint32_t> decisions;
    for (const std::vector<uint32_t>& kind : engine.compiled().kinds) {
        for (uint32_t i = 0; i < points.count; ++i)
            decisions.push_back(winnerAmong(kind, all, i).output);
    }
    return decisions;
}

} // namespace

std::vector<Diagnostic> lintTrace(const Engine& engine, const FactTrace& trace)
{
    constexpr double kMost = 0.05; // of the frames
    DiagnosticSink sink(engine.base().file);
    const std::size_t factCount = engine.facts().size();
    if (factCount == 0 || trace.rows.size() < factCount) return {};
    assert(trace.frames.empty() || trace.frames.size() == trace.rows.size() / factCount);
    const SamplePoints points = toPoints(engine, trace);
    const std::vector<uint32_t> decisions = decisionsAt(engine, points);
    for (std::size_t v = 0; v < engine.base().variables.size(); ++v) {
        const uint32_t fact = engine.compiled().variables[v].fact;
        const double noise = trace.noise.empty() ? estimatedNoise(trace, factCount, fact) : trace.noise[fact];
        if (!(noise > 0.0)) continue;
        std::vector<bool> overturned(points.count, false);
        for (const double direction : {-1.0, 1.0}) {
            SamplePoints moved = points;
            for (uint32_t i = 0; i < moved.count; ++i)
                moved.at(fact, i) += direction * noise;
            const std::vector<uint32_t> other = decisionsAt(engine, moved);
            for (std::size_t i = 0; i < other.size(); ++i)
                overturned[i % points.count] = overturned[i % points.count] || other[i] != decisions[i];
        }
        const auto count = std::count(overturned.begin(), overturned.end(), true);
        if (static_cast<double>(count) <= kMost * points.count) continue;
        const auto row = std::find(overturned.begin(), overturned.end(), true) - overturned.begin();
        const auto first =
            trace.frames.empty() ? static_cast<uint32_t>(row) : trace.frames[static_cast<std::size_t>(row)];
        sink.warning("L08", engine.base().variables[v].at,
                     "noise of " + shortestText(noise) + " in " + inQuotes(engine.base().variables[v].name) +
                         " overturns the decision in " +
                         fixedText(100.0 * static_cast<double>(count) / points.count, 1) +
                         " % of the trace, first in frame " + std::to_string(first));
    }
    return sink.take();
}

} // namespace gnomon::rules
