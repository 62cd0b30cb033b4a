#pragma once
// What the depths and corners of long and of thin triangles are rounded by, and what follows for rays.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Metres. What corners of shorter triangles are rounded by counts in the offset of every receiver (cornersOf(),
/// scene_view.hpp): at most 8 micrometres, a sixth of what the width of a pixel adds 10 m away (1280x720). What those
/// of longer ones are rounded by counts against hits on them alone (startsOn()).
inline constexpr float kLongEdge = 64.0f;

/// What a triangle is measured by.
struct Thinness {
    double area;   ///< Twice the area, which is L h.
    double length; ///< L: the longest edge.
    double height; ///< h: above that.

    Thinness(const glm::dvec3& ab, const glm::dvec3& bc, const glm::dvec3& ca, const glm::dvec3& normal)
        : area(glm::length(normal)),
          length(std::sqrt(std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)}))), height(area / length)
    {
    }
};

/// Whether a ray starts on the triangle itself, as far as that can be told: hits on it then count for nothing. The
/// start may be off the plane by the larger of two lengths.
///
/// 2^-22 L, what corners are rounded by: depths of grounds of two triangles were off by up to 2^-24.2 L (4 km,
/// lavapipe).
///
/// 2^-22 l^2 / h, l = min(L, kLongEdge): rasterisers find the slope of depths from differences of products, which
/// cancel where a triangle is thin. Depths of needles were off by up to 2^-23.2 of that (11 m long, 46 mm wide, seen
/// from 6 m, lavapipe). At most h / 4, so that the sides of a needle are told apart.
inline bool startsOn(const glm::dvec3 (&corners)[3], const glm::dvec3& start)
{
    const glm::dvec3 ab = corners[1] - corners[0], bc = corners[2] - corners[1], ca = corners[0] - corners[2];
    const glm::dvec3 normal = glm::cross(ab, bc);
    const Thinness t(ab, bc, ca, normal);
    const double l = std::min(t.length, double{kLongEdge});
    const double off = std::max(0x1p-22 * t.length, std::min(0x1p-22 * l * l / t.height, 0.25 * t.height));
    return std::abs(glm::dot(normal, start - corners[0])) <= off * t.area;
}

/// L^2 / h, metres: startsOn() asks for no more than 2^-22 of it.
inline double effectiveLength(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    const Thinness t(b - a, c - b, a - c, glm::cross(b - a, c - b));
    return t.length * t.length / t.height;
}

/// The largest of a mesh's triangles, object space.
inline float longestOf(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    double longest = 0.0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        longest =
            std::max(longest, effectiveLength(glm::dvec3(positions[indices[i]]), glm::dvec3(positions[indices[i + 1]]),
                                              glm::dvec3(positions[indices[i + 2]])));
    return static_cast<float>(longest);
}

/// Whether there may be triangles of a caster for which startsOn() matters. L^2 / h grows by the square of the largest
/// stretch over the least at most.
/// @param longest longestOf() its mesh
inline bool isLong(const Caster& caster, float longest)
{
    const glm::dmat3 forward(caster.basis), back = glm::inverse(forward);
    const auto stretch = [](const glm::dmat3& m) { // an upper bound
        return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
    };
    // Both bounds are root 3 of what a rotation stretches by.
    return stretch(forward) * stretch(forward) * stretch(back) * double{longest} > 5.2 * double{kLongEdge};
}

} // namespace gnomon
