#include "demo/program/receivers.hpp"

#include <cmath>

namespace gnomon::demo {

gpu::ViewConstants viewConstants(const Scene& scene, const CameraMatrices& camera, VkExtent2D extent)
{
    gpu::ViewConstants view{};
    view.clipFromWorld = camera.clipFromEye;
    view.rayCornerWs = glm::vec4(camera.rayCorner, 0.0f);
    view.rayDxWs = glm::vec4(camera.rayDx, 0.0f);
    view.rayDyWs = glm::vec4(camera.rayDy, 0.0f);
    view.depthScale = camera.depthScale;
    view.depthMul = 1.0f;
    view.depthAdd = camera.depthAdd;
    view.skyDepth = camera.skyDepth;
    view.offsetFactor = scene.depth.convention == DepthConvention::Standard ? 3.0f : 1.0f;
    view.pixelSize = 2.0f / (std::abs(camera.projection[1][1]) * static_cast<float>(extent.height));
    view.hasNormals = 1;
    return view;
}

gpu::LightConstants lightConstants(const Light& light, const LightState& state, const glm::dvec3& eye)
{
    constexpr float unlimited = 1e30f; // metres; squares of it stay finite nowhere, so nobody may square it
    gpu::LightConstants out{};
    const bool directional = light.kind == LightKind::Directional;
    out.positionWs = glm::vec4(glm::vec3(state.position - eye), directional ? 0.0f : 1.0f);
    // -2 lies below every cosine: no cone.
    const float cosine = light.kind == LightKind::Spot ? std::cos(light.outerAngle) : -2.0f;
    out.directionWs = glm::vec4(glm::vec3(state.direction), cosine);
    out.range = light.range > 0.0f ? light.range : unlimited;
    out.type = static_cast<uint32_t>(light.kind);
    return out;
}

} // namespace gnomon::demo
