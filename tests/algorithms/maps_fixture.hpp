#pragma once
// Cameras, lights and casters for the tests of maps; no device.
#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"

namespace gnomon::test {

struct Random {
    std::mt19937 engine{20250307};
    float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    glm::vec3 vec(float low, float high)
    {
        const float x = in(low, high), y = in(low, high);
        return {x, y, in(low, high)};
    }
    glm::vec3 unit()
    {
        for (;;) {
            const glm::vec3 v = vec(-1.0f, 1.0f);
            const float length = glm::length(v);
            if (length > 0.1f && length < 1.0f) return v / length;
        }
    }
};

/// Reversed-Z, infinite far, square pixels.
inline CameraView camera(glm::vec3 eye, glm::vec3 forward, float halfAngle, std::uint32_t width, std::uint32_t height)
{
    constexpr float kNear = 0.1f;
    CameraView view;
    const glm::vec3 up = std::fabs(forward.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 right = glm::normalize(glm::cross(forward, up)), down = glm::cross(forward, right);
    for (int i = 0; i < 3; ++i)
        view.viewFromWorld[i] = {right[i], -down[i], -forward[i]};
    const float half = std::tan(halfAngle), pixel = 2.0f * half / static_cast<float>(height);
    gpu::ViewConstants& c = view.constants;
    c.rayDxWs = glm::vec4(right * pixel, 0.0f);
    c.rayDyWs = glm::vec4(down * pixel, 0.0f);
    c.rayCornerWs = glm::vec4(forward - down * half - right * (0.5f * pixel * static_cast<float>(width)), 0.0f);
    c.eyeWs = glm::vec4(eye, 1.0f);
    c.depthScale = kNear;
    c.depthMul = 1.0f;
    c.depthAdd = 0.0f;
    c.skyDepth = 0.0f;
    c.offsetFactor = 1.0f;
    c.pixelSize = pixel;
    c.hasNormals = 1;
    view.eye = eye;
    view.extent = {width, height};
    view.area = {{0, 0}, {width, height}};
    const glm::vec2 size(static_cast<float>(width), static_cast<float>(height));
    const glm::vec2 ring[4] = {{0, 0}, {size.x, 0}, size, {0, size.y}};
    for (std::size_t i = 0; i < 4; ++i)
        view.nearCorners[i] = eye + kNear * gpu::viewRayWs(c, ring[i]);
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 side =
            glm::normalize(glm::cross(gpu::viewRayWs(c, ring[i]), gpu::viewRayWs(c, ring[(i + 1) % 4])));
        const glm::vec3 inward = glm::dot(side, forward) < 0.0f ? -side : side;
        view.frustum[i] = {inward, -glm::dot(inward, eye)};
    }
    view.frustum[4] = {forward, -glm::dot(forward, eye) - kNear};
    view.frustum[5] = {glm::vec3(0.0f), 1.0f};
    return view;
}

inline LightView light(GnLightType type, glm::vec3 position, glm::vec3 direction, float range, float coneAngle = 0.6f)
{
    LightView light;
    light.id = 1;
    light.type = type;
    light.coneAngle = coneAngle;
    light.revision = 7;
    light.constants.positionWs = glm::vec4(position, type == GN_LIGHT_TYPE_DIRECTIONAL ? 0.0f : 1.0f);
    light.constants.directionWs = glm::vec4(direction, type == GN_LIGHT_TYPE_SPOT ? std::cos(coneAngle) : -2.0f);
    light.constants.range = range;
    light.constants.type = static_cast<std::uint32_t>(type);
    return light;
}

} // namespace gnomon::test
