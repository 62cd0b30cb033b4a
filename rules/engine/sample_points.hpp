#pragma once

/// Points in the space of facts for checks that look instead of prove, and decisions at them.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

/// One row of facts a point; facts that the rules do not read are 0.
struct SamplePoints {
    SamplePoints(const Engine& engine, uint32_t points)
        : count(points), factCount(engine.facts().size()), facts(factCount * points, 0.0)
    {
    }

    uint32_t count;
    std::size_t factCount;
    std::vector<double> facts;

    double at(uint32_t fact, uint32_t point) const noexcept { return facts[point * factCount + fact]; }
    double& at(uint32_t fact, uint32_t point) noexcept { return facts[point * factCount + fact]; }
};

/// Evenly over the volume of all universes, whole numbers for counts: an additive recurrence with the powers of the
/// root of x^(d+1) = x + 1 (M. Roberts 2018), the golden ratio for one fact. The same points everywhere.
SamplePoints evenPoints(const Engine& engine, uint32_t count);

/// Evenly over the cells on which no term changes between false, partly true and true, however small they are.
SamplePoints cellPoints(const Engine& engine, uint32_t count);

/// What the rules say at every point.
struct Opinions {
    std::size_t outputCount;
    std::vector<OutputState> outputs; ///< One row a point.
    std::vector<double> floorTruth;   ///< As in Inference.

    const OutputState& at(uint32_t output, uint32_t point) const noexcept
    {
        return outputs[point * outputCount + output];
    }
};
Opinions opinionsAt(const Engine& engine, const SamplePoints& points);

/// The best of several outputs. Equals go to the earlier one.
struct Winner {
    uint32_t output = kNoRule;   ///< kNoRule: none that is not vetoed has an opinion.
    uint32_t runnerUp = kNoRule; ///< Another with the same suitability.
};
Winner winnerAmong(std::span<const uint32_t> outputs, const Opinions& all, uint32_t point) noexcept;

/// "dynamicLights = 3, viewerDistance = 12.5"
std::string pointText(const Engine& engine, const SamplePoints& points, uint32_t point);

} // namespace gnomon::rules
