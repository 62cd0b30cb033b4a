#include "algorithms/volumes/shadow_reach.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace gnomon {

namespace {

constexpr float kNoEnd = 1e30f;        // metres
constexpr float kLongestRange = 1e15f; // metres; beyond, a range is no range and squares leave float

/// The convex set of the z-pass test: five points, or four and a direction in which it has no end.
struct Pyramid {
    std::array<glm::vec3, 5> points;
    int pointCount = 5;
    glm::vec3 endless{0.0f}; ///< Zero: bounded.
};

/// Whether projections on the axis lie apart. The axis need not have unit length; a zero one separates nothing.
bool separates(const glm::vec3& axis, const Pyramid& pyramid, const Aabb& box)
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
    // Side planes hold the direction by construction, so up to rounding the set ends there.
    const float endless = glm::dot(unit, pyramid.endless);
    if (endless > 1e-5f) high = kNoEnd;
    if (endless < -1e-5f) low = -kNoEnd;
    const float margin = 4e-6f * size; // 32 ulp of the largest coordinate
    return centre + radius + margin < low || high + margin < centre - radius;
}

} // namespace

bool shadowsNearRectangle(const Aabb& box, const LightView& light, const std::array<glm::vec3, 4>& nearCorners)
{
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

    for (const glm::vec3& unit : kUnits)
        if (separates(unit, pyramid, box)) return false;
    if (separates(glm::cross(edges[4], edges[5]), pyramid, box)) return false;
    for (std::size_t i = 0; i < 4; ++i)
        if (separates(glm::cross(edges[i], edges[4 + i % 2]), pyramid, box)) return false;
    for (const glm::vec3& edge : edges)
        for (const glm::vec3& unit : kUnits)
            if (separates(glm::cross(edge, unit), pyramid, box)) return false;
    return true;
}

bool shadowTouches(const Aabb& box, const LightView& light, std::span<const Plane> frustum)
{
    const glm::vec3 center = box.center(), half = box.halfExtent();
    const float size = glm::length(glm::abs(center)) + glm::length(half);
    for (const Plane& plane : frustum) {
        const glm::vec3 extent = glm::abs(plane.normal) * half;
        const float radius = extent.x + extent.y + extent.z;
        const float nearest = glm::dot(plane.normal, center) + plane.distance + radius;
        if (nearest >= -4e-6f * size) continue; // not outside this plane
        // The box lies outside; its shadow does too if light takes it further out.
        const float inwards = light.type == GN_LIGHT_TYPE_DIRECTIONAL
                                  ? glm::dot(plane.normal, light.direction())
                                  : glm::dot(plane.normal, center - light.position()) + radius;
        if (inwards <= 0.0f) return false;
    }
    return true;
}

Aabb lightBounds(const LightView& light)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return {glm::vec3(-kNoEnd), glm::vec3(kNoEnd)};
    const float range = light.constants.range < kLongestRange ? light.constants.range : kNoEnd;
    Aabb bounds{light.position() - range, light.position() + range};
    if (light.type != GN_LIGHT_TYPE_SPOT) return bounds;
    // A cone around `direction` leaves the apex along an axis by range * max(0, cos(angle to the axis - half angle)).
    for (int axis = 0; axis < 3; ++axis) {
        const float toAxis = std::acos(std::clamp(light.direction()[axis], -1.0f, 1.0f));
        const float up = std::max(toAxis - light.coneAngle, 0.0f);
        const float down = std::max(3.14159265f - toAxis - light.coneAngle, 0.0f);
        bounds.upper[axis] = light.position()[axis] + range * std::max(std::cos(up), 0.0f);
        bounds.lower[axis] = light.position()[axis] - range * std::max(std::cos(down), 0.0f);
    }
    return bounds;
}

bool lightPixels(const LightView& light, const CameraView& view, VkRect2D& pixels)
{
    pixels = view.area;
    const Aabb bounds = lightBounds(light);
    for (int axis = 0; axis < 3; ++axis)
        if (bounds.upper[axis] - bounds.lower[axis] > kLongestRange) return true;
    glm::vec2 low(kNoEnd), high(-kNoEnd);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? bounds.upper.x : bounds.lower.x,
                          (corner & 2) ? bounds.upper.y : bounds.lower.y,
                          (corner & 4) ? bounds.upper.z : bounds.lower.z);
        const glm::vec4 clip = view.constants.clipFromWorld * glm::vec4(p, 1.0f);
        if (clip.w < 1e-3f) return true; // reaches behind the eye: its picture has no simple bounds
        low = glm::min(low, glm::vec2(clip) / clip.w);
        high = glm::max(high, glm::vec2(clip) / clip.w);
    }
    const auto toPixels = [](float ndc, std::int32_t offset, std::uint32_t size) {
        return static_cast<float>(offset) + (0.5f + 0.5f * std::clamp(ndc, -1.0f, 1.0f)) * static_cast<float>(size);
    };
    const VkRect2D& area = view.area;
    // One pixel around covers the rounding.
    const auto left = static_cast<std::int32_t>(toPixels(low.x, area.offset.x, area.extent.width)) - 1;
    const auto top = static_cast<std::int32_t>(toPixels(low.y, area.offset.y, area.extent.height)) - 1;
    const auto right = static_cast<std::int32_t>(toPixels(high.x, area.offset.x, area.extent.width)) + 2;
    const auto bottom = static_cast<std::int32_t>(toPixels(high.y, area.offset.y, area.extent.height)) + 2;
    if (low.x > 1.0f || low.y > 1.0f || high.x < -1.0f || high.y < -1.0f) return false;
    pixels.offset = {std::max(left, area.offset.x), std::max(top, area.offset.y)};
    pixels.extent.width = static_cast<std::uint32_t>(
        std::min(right, area.offset.x + static_cast<std::int32_t>(area.extent.width)) - pixels.offset.x);
    pixels.extent.height = static_cast<std::uint32_t>(
        std::min(bottom, area.offset.y + static_cast<std::int32_t>(area.extent.height)) - pixels.offset.y);
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

} // namespace gnomon
