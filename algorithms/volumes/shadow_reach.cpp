#include "algorithms/volumes/shadow_reach.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "shaders/volumes/wedge.h"

namespace gnomon {

namespace {

constexpr float kNoEnd = 1e30f; // metres

/// The convex set of the z-pass test: five points, or four and a direction in which it has no end.
struct Pyramid {
    std::array<glm::vec3, 5> points;
    int pointCount = 5;
    glm::vec3 endless{0.0f}; ///< Zero: bounded.
};

/// Whether projections on the axis lie apart. The axis need not have unit length; a zero one separates nothing.
/// @param drift along the axis that counts as none, of the direction without an end
bool separates(const glm::vec3& axis, const Pyramid& pyramid, const Aabb& box, float drift)
{
    const float length = glm::length(axis);
    if (!(length > 0.0f)) return false;
    const glm::vec3 unit = axis / length;
    const glm::vec3 half = box.halfExtent();
    const float centre = glm::dot(unit, box.center());
    const float radius = std::abs(unit.x) * half.x + std::abs(unit.y) * half.y + std::abs(unit.z) * half.z;
    float low = kNoEnd, high = -kNoEnd, size = std::abs(centre) + radius;
    for (int i = 0; i < pyramid.pointCount; ++i) {
        const float p = glm::dot(unit, pyramid.points[static_cast<std::size_t>(i)]);
        low = std::min(low, p);
        high = std::max(high, p);
        size = std::max(size, std::abs(p));
    }
    const float endless = glm::dot(unit, pyramid.endless);
    if (endless > drift) high = kNoEnd;
    if (endless < -drift) low = -kNoEnd;
    const float margin = 4e-6f * size; // 32 ulp of the largest coordinate
    return centre + radius + margin < low || high + margin < centre - radius;
}

} // namespace

bool shadowsNearRectangle(const Aabb& caster, const LightView& light, const std::array<glm::vec3, 4>& nearCorners,
                          float sourceRadius)
{
    // A way from inside of a wedge through its edge passes the source's centre as close as the wedge's rays do, and
    // comes no farther from the way through the centre before.
    const glm::vec3 aside(gpu::WEDGE_SPREAD * sourceRadius);
    const Aabb box{caster.lower - aside, caster.upper + aside};
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    Pyramid pyramid;
    std::copy(nearCorners.begin(), nearCorners.end(), pyramid.points.begin());
    pyramid.points[4] = light.position();
    if (directional) {
        pyramid.pointCount = 4;
        pyramid.endless = -light.direction();
    }

    // Separating axes of two convex polyhedra: face normals of either, and cross products of their edges.
    static constexpr glm::vec3 kUnits[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::array<glm::vec3, 6> edges; // four towards the light, two along the rectangle
    for (std::size_t i = 0; i < 4; ++i)
        edges[i] = directional ? pyramid.endless : light.position() - nearCorners[i];
    edges[4] = nearCorners[1] - nearCorners[0];
    edges[5] = nearCorners[2] - nearCorners[1];

    // What is made with a way towards the light is at right angles to it, so up to rounding the set ends there. Of
    // other axes the least drift counts: over a caster's height a thousandth of a degree is as wide as a near
    // rectangle.
    constexpr float kRounding = 1e-5f, kNone = 0.0f;
    for (const glm::vec3& unit : kUnits)
        if (separates(unit, pyramid, box, kNone)) return false;
    if (separates(glm::cross(edges[4], edges[5]), pyramid, box, kNone)) return false;
    for (std::size_t i = 0; i < 4; ++i)
        if (separates(glm::cross(edges[i], edges[4 + i % 2]), pyramid, box, kRounding)) return false;
    for (std::size_t i = 0; i < edges.size(); ++i)
        for (const glm::vec3& unit : kUnits)
            if (separates(glm::cross(edges[i], unit), pyramid, box, i < 4 ? kRounding : kNone)) return false;
    return true;
}

bool shadowTouches(const Aabb& box, const LightView& light, std::span<const Plane> frustum, float sourceRadius)
{
    if (!reaches(light, box)) return false;
    const glm::vec3 center = box.center(), half = box.halfExtent();
    const float size = glm::length(glm::abs(center)) + glm::length(half);
    for (const Plane& plane : frustum) {
        const glm::vec3 extent = glm::abs(plane.normal) * half;
        const float radius = extent.x + extent.y + extent.z;
        const float nearest = glm::dot(plane.normal, center) + plane.distance + radius;
        if (nearest >= -4e-6f * size) continue; // not outside this plane
        // The box lies outside; its shadow does too if light takes it further out, from wherever on the source.
        const float inwards = light.type == GN_LIGHT_TYPE_DIRECTIONAL
                                  ? glm::dot(plane.normal, light.direction())
                                  : glm::dot(plane.normal, center - light.position()) + radius + sourceRadius;
        if (inwards <= 0.0f) return false;
    }
    return true;
}

glm::vec3 casterReach(const Aabb& box, const LightView& light, glm::vec3 eye)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return box.center() - eye;
    const glm::vec3 lower = box.lower - light.position(), upper = box.upper - light.position();
    glm::vec3 reach(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
        // Bounds that come closer than a ten-thousandth of their far side would send vertices to the horizon.
        const float least = 1e-4f * std::max(std::abs(lower[axis]), std::abs(upper[axis]));
        if (lower[axis] > least) reach[axis] = lower[axis];
        if (upper[axis] < -least) reach[axis] = upper[axis];
    }
    return reach;
}

Aabb eyeBounds(const CameraView& view)
{
    Aabb box{view.eye, view.eye};
    for (const glm::vec3& corner : view.nearCorners)
        box = unionOf(box, {corner, corner});
    return box;
}

} // namespace gnomon
