#include "runtime/scene/light_pixels.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

constexpr float kNoEnd = 1e30f;        // metres
constexpr float kLongestRange = 1e15f; // metres; beyond, a range is no range and squares leave float

} // namespace

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

VkRect2D lightPixels(const LightView& light, const CameraView& view)
{
    VkRect2D pixels = view.area;
    const Aabb bounds = lightBounds(light);
    for (int axis = 0; axis < 3; ++axis)
        if (bounds.upper[axis] - bounds.lower[axis] > kLongestRange) return pixels;
    glm::vec2 low(kNoEnd), high(-kNoEnd);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? bounds.upper.x : bounds.lower.x,
                          (corner & 2) ? bounds.upper.y : bounds.lower.y,
                          (corner & 4) ? bounds.upper.z : bounds.lower.z);
        const glm::vec4 clip = view.constants.clipFromWorld * glm::vec4(p, 1.0f);
        if (clip.w < 1e-3f) return pixels; // reaches behind the eye: its picture has no simple bounds
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
    if (low.x > 1.0f || low.y > 1.0f || high.x < -1.0f || high.y < -1.0f) return {view.area.offset, {0, 0}};
    pixels.offset = {std::max(left, area.offset.x), std::max(top, area.offset.y)};
    pixels.extent.width = static_cast<std::uint32_t>(
        std::min(right, area.offset.x + static_cast<std::int32_t>(area.extent.width)) - pixels.offset.x);
    pixels.extent.height = static_cast<std::uint32_t>(
        std::min(bottom, area.offset.y + static_cast<std::int32_t>(area.extent.height)) - pixels.offset.y);
    return pixels;
}

bool canBeSeen(const LightView& light, const CameraView& view)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL || !(light.constants.range < kLongestRange)) return true;
    const Aabb bounds = lightBounds(light);
    const glm::vec3 middle = bounds.center(), half = bounds.upper - middle;
    const float slack = 1e-5f * (glm::length(middle) + glm::length(half)); // a hundred times what floats round by
    return std::all_of(view.frustum.begin(), view.frustum.end(), [&](const Plane& plane) {
        const float box = glm::dot(glm::abs(plane.normal), half);
        const float reach = light.type == GN_LIGHT_TYPE_POINT ? std::min(box, light.constants.range) : box;
        return glm::dot(plane.normal, middle) + plane.distance >= -reach - slack;
    });
}

} // namespace gnomon
