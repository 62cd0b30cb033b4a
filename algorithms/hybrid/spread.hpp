#pragma once
// How a transform spreads what is rounded in an object's space: the ray tracer moves rays there and back.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace gnomon {

/// |basis| |inverse basis|: an error of 1 in each coordinate may become this much of each. The ray tracer makes the
/// inverse of cross products and a determinant in single precision; where their terms cancel, as in what is squashed
/// along two axes aslant to its own, their sizes stand in place of what is left of them.
inline glm::dmat3 spreadOf(const glm::dmat3& basis)
{
    const auto termsOf = [](const glm::dvec3& a, const glm::dvec3& b) { // of a cross product, sizes
        const glm::dvec3 p = glm::abs(a), q = glm::abs(b);
        return glm::dvec3(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
    };
    const double determinant = std::abs(glm::dot(basis[0], glm::cross(basis[1], basis[2])));
    // An error of the determinant scales the whole inverse, and so what comes back.
    glm::dmat3 spread(glm::dot(glm::abs(basis[0]), termsOf(basis[1], basis[2])) / determinant - 1.0);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 &a = basis[(k + 1) % 3], &b = basis[(k + 2) % 3];
        const glm::dvec3 inverse = termsOf(a, b) / determinant; // its row k
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row)
                spread[column][row] += std::abs(basis[k][row]) * inverse[column];
    }
    return spread;
}

/// The most that a coordinate collects: 1 where axes stay axes, some 3 for a rotation, more for what is sheared or
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
