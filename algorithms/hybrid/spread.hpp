#pragma once
// How a transform spreads what is rounded in an object's space: the ray tracer moves rays there and back.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace gnomon {

/// |basis| |inverse basis|: an error of 1 in each coordinate may become this much of each.
inline glm::dmat3 spreadOf(const glm::dmat3& basis)
{
    const glm::dmat3 inverse = glm::inverse(basis);
    glm::dmat3 spread(0.0);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            for (int k = 0; k < 3; ++k)
                spread[column][row] += std::abs(basis[k][row]) * std::abs(inverse[column][k]);
    return spread;
}

/// The most that a coordinate collects: 1 where axes stay axes, at most 3 for a rotation, more for what is sheared or
/// squashed aslant.
inline double skewOf(const glm::dmat3& spread)
{
    const glm::dvec3 rows = spread * glm::dvec3(1.0);
    return std::max({1.0, rows.x, rows.y, rows.z});
}

/// By how many times an object's space may be off by more than that of one that is only turned, and scaled along its
/// own axes: 1 for those, whose axes stay at right angles (to 1/1000: all but that of the 3 above), found without
/// inverting anything.
inline double skewBeyondTurning(const glm::mat3& basis)
{
    const glm::dmat3 b(basis);
    const auto square = [&](int i, int k) {
        const double along = glm::dot(b[i], b[k]);
        return along * along <= 1e-6 * glm::dot(b[i], b[i]) * glm::dot(b[k], b[k]);
    };
    if (square(0, 1) && square(1, 2) && square(2, 0)) return 1.0;
    constexpr double kMost = 1e6; // what is off by so many roundings is nowhere; a float holds what follows
    return std::clamp(skewOf(spreadOf(b)) / 3.0, 1.0, kMost);
}

} // namespace gnomon
