// How a light sees a tile, and what the triangles of a caster are to it: set up once, in double precision, for the
// kernels that take sixteen triangles at a time (simd_volumes.inc).
#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "algorithms/hybrid/shaft.hpp"

namespace gnomon {

namespace {

constexpr double kRoundoff = 0x1p-24;
// Of distances between receiver, triangle and light. Embree's edge functions and ours are sums of products of such
// differences: four roundings each, and as many for the planes in single precision; twice that is allowed.
constexpr double kDistanceRoundings = 16.0 * kRoundoff;
// Of the frame's axes, and of what is projected onto them: far more than single precision loses.
constexpr double kFrameRoundings = 1e-6;
// A light that is closer to the hull's top than this part of its distance sees no frame.
constexpr double kClosest = 1e-2;

void copy(glm::dvec3 from, float (&to)[3])
{
    for (int k = 0; k < 3; ++k)
        to[k] = static_cast<float>(from[k]);
}

glm::dvec3 at(const float (&from)[3])
{
    return {from[0], from[1], from[2]};
}

} // namespace

bool frameOf(const ShaftLight& light, const Hull& hull, simd::LightFrame& frame)
{
    const glm::dvec3 way = light.directional ? light.toLight : light.position - hull.centre;
    const double distance = glm::length(way);
    if (!(distance > 0.0)) return false;
    const glm::dvec3 towards = way / distance;
    if (!light.directional && !(distance - hull.radius(towards) > kClosest * distance)) return false;
    // Across: along the hull's rows, as far as they are across.
    glm::dvec3 across = hull.axis[0] - towards * glm::dot(towards, hull.axis[0]);
    if (!(glm::dot(across, across) > 1e-4)) across = hull.axis[1] - towards * glm::dot(towards, hull.axis[1]);
    across = glm::normalize(across);
    copy(hull.centre, frame.centre);
    copy(across, frame.axis[0]);
    copy(glm::cross(towards, across), frame.axis[1]);
    copy(towards, frame.axis[2]);
    frame.distance = light.directional ? 0.0f : static_cast<float>(distance);
    frame.directional = light.directional ? 1 : 0;
    return true;
}

simd::FrameBounds boundsIn(const simd::LightFrame& frame, const Hull& hull)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const glm::dvec3 centre = hull.centre - at(frame.centre);
    double lower[3] = {infinity, infinity, infinity}, upper[3] = {-infinity, -infinity, -infinity};
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec3 p = centre;
        for (int i = 0; i < 3; ++i)
            p += hull.axis[i] * (corner >> i & 1 ? hull.half[i] : -hull.half[i]);
        const double height = glm::dot(p, at(frame.axis[2]));
        const double left = double(frame.distance) - height;
        const bool ahead = frame.directional || left > kClosest * frame.distance;
        const double scale = frame.directional ? 1.0 : frame.distance / left;
        const double place[3] = {glm::dot(p, at(frame.axis[0])) * scale, glm::dot(p, at(frame.axis[1])) * scale,
                                 height};
        for (int k = 0; k < 3; ++k) {
            lower[k] = std::min(lower[k], ahead || k == 2 ? place[k] : -infinity);
            upper[k] = std::max(upper[k], ahead || k == 2 ? place[k] : infinity);
        }
    }
    simd::FrameBounds bounds;
    for (int k = 0; k < 3; ++k) {
        const double grow = 4.0 * kFrameRoundings * std::max(std::abs(lower[k]), std::abs(upper[k]));
        bounds.lower[k] = static_cast<float>(lower[k] - grow);
        bounds.upper[k] = static_cast<float>(upper[k] + grow);
    }
    return bounds;
}

simd::TriangleLookup lookOf(const ShaftLight& light, const Hull& hull, const simd::LightFrame& frame,
                            const ShaftCaster& caster)
{
    // The frame's centre is the hull's, rounded; planes are asked relative to it.
    const glm::dvec3 centre = at(frame.centre);
    simd::TriangleLookup look;
    look.frame = frame;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            look.basis[column][row] = caster.basis[column][row];
    for (int k = 0; k < 3; ++k)
        look.translation[k] = caster.translation[k] - centre[k];
    copy(light.directional ? light.toLight : light.position - centre, look.light);
    const glm::dvec3 off = glm::abs(hull.centre - centre);
    for (int i = 0; i < 3; ++i)
        copy(hull.axis[i] * (hull.half[i] + glm::dot(off, glm::abs(hull.axis[i]))), look.axis[i]);
    const glm::dvec3 extent = hull.extent() + off;
    copy(extent, look.extent);
    copy((1.0 + 1e-6) * caster.rounding(hull.largest()), look.rounding);
    const glm::dvec3 anywhere = caster.rounding(caster.reach + glm::max(hull.largest(), light.largest()));
    const double reach =
        extent.x + extent.y + extent.z + (light.directional ? 0.0 : glm::length(light.position - centre));
    look.unsure = static_cast<float>(4.0 * (anywhere.x + anywhere.y + anywhere.z) + kFrameRoundings * reach);
    look.relative = static_cast<float>(kDistanceRoundings * caster.skew());
    look.farthest =
        light.directional ? 0.0f : static_cast<float>(glm::length(light.position - centre) + glm::length(extent));
    look.nearOffset = static_cast<float>(2.0 * hull.largestOffset);
    look.opaque = caster.opaque ? 1 : 0;
    return look;
}

} // namespace gnomon
