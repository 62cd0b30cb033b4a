#include "demo/program/receivers.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/scene/long_edges.hpp"

namespace gnomon::demo {

namespace {

double largest(const glm::dvec3& v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Longest edge of a triangle, in the world but for its rotation.
double longestEdge(const Mesh& mesh, const glm::dvec3& scale)
{
    double longest = 0.0;
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        const size_t next = i % 3 == 2 ? i - 2 : i + 1;
        const glm::dvec3 from(mesh.positions[mesh.indices[i]]), to(mesh.positions[mesh.indices[next]]);
        longest = std::max(longest, glm::length(scale * (to - from)));
    }
    return longest;
}

/// Largest coordinate of a mesh from its own zero, likewise.
double reach(const Mesh& mesh, const glm::dvec3& scale)
{
    double most = 0.0;
    for (const glm::vec3& position : mesh.positions)
        most = std::max(most, largest(scale * glm::dvec3(position)));
    return most;
}

/// gpu::ViewConstants::corners, by the scene's own numbers: for all times, and as if nothing were turned.
double corners(const Scene& scene, const glm::dvec3& eye)
{
    double edge = 0.0, away = 0.0;
    for (const Instance& instance : scene.instances) {
        if (instance.hostDrawn) continue;
        const bool moves = !instance.keys.empty();
        glm::dvec3 scale = moves ? glm::dvec3(0.0) : instance.pose.scale;
        for (const PoseKey& key : instance.keys)
            scale = glm::max(scale, key.pose.scale);
        const Mesh& mesh = scene.meshes[instance.mesh];
        edge = std::max(edge, longestEdge(mesh, scale));
        const double most = reach(mesh, scale);
        away = std::max(away, moves ? most : std::min(most, largest(eye - instance.pose.position)));
    }
    return std::max(0.25 * std::min(edge, double{kLongEdge}), 0.5 * away);
}

} // namespace

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
    view.corners = static_cast<float>(corners(scene, camera.eye));
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
