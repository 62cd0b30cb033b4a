#include "demo/program/ambiguity.hpp"

#if GNOMON_WITH_EMBREE

#include <array>
#include <cstring>
#include <limits>

#include "demo/program/receivers.hpp"
#include "runtime/rays/ray_scene.hpp"

namespace gnomon::demo {
namespace {

constexpr float kMovePixels = 1.0f / 128.0f;
// The receiver as it is, moved four ways, its offset halved and doubled.
constexpr size_t kVariants = 7;
constexpr std::array<glm::vec2, kVariants> kMoves = {
    {{0, 0}, {kMovePixels, 0}, {-kMovePixels, 0}, {0, kMovePixels}, {0, -kMovePixels}, {0, 0}, {0, 0}}};
constexpr std::array<float, kVariants> kOffsets = {1, 1, 1, 1, 1, 0.5f, 2};

/// All triangles that cast, world axes, relative to the eye.
struct FlatScene {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    RayScene rays;
    std::unique_ptr<MeshRays> tree;
    MeshView mesh;

    FlatScene(const Scene& scene, const SceneState& state, const glm::dvec3& eye)
    {
        for (size_t i = 0; i < scene.instances.size(); ++i) {
            const Mesh& source = scene.meshes[scene.instances[i].mesh];
            const Transform& transform = state.instances[i];
            const auto first = static_cast<uint32_t>(positions.size());
            for (const glm::vec3& p : source.positions)
                positions.emplace_back(glm::dmat3(transform.linear) * glm::dvec3(p) + transform.translation - eye);
            for (uint32_t index : source.indices)
                indices.push_back(first + index);
        }
        positions.reserve(positions.size() + 1); // Embree reads four bytes past the last
        tree = rays.build(positions, indices);
        mesh.positions = positions;
        mesh.indices = indices;
        mesh.rays = tree.get();
        Caster caster;
        caster.mesh = &mesh;
        caster.bounds = {glm::vec3(-1e30f), glm::vec3(1e30f)};
        caster.revision = 1;
        rays.update({&caster, 1});
    }
};

ShadowRay rayOf(const gpu::ViewConstants& view, const gpu::LightConstants& light, glm::vec2 pixel, float depth,
                glm::vec3 normal, size_t variant)
{
    const glm::vec3 straight = gpu::viewRayWs(view, pixel);
    glm::vec3 receiver = straight * gpu::linearDepth(view, depth);
    const glm::vec3 moved = gpu::viewRayWs(view, pixel + kMoves[variant]);
    receiver = moved * (glm::dot(normal, receiver) / glm::dot(normal, moved));
    const float offset = kOffsets[variant] * gpu::receiverOffset(view, light, depth, straight, receiver, normal);
    const glm::vec3 origin = receiver + normal * offset;
    if (light.type == gpu::LIGHT_DIRECTIONAL)
        return {origin, std::numeric_limits<float>::infinity(), -glm::vec3(light.directionWs)};
    const glm::vec3 toLight = glm::vec3(light.positionWs) - origin;
    return {origin, 1.0f - offset / glm::length(toLight), toLight};
}

} // namespace

std::vector<uint8_t> ambiguousPixels(const Scene& scene, const SceneState& state, const CameraMatrices& camera,
                                     const FrameSurfaces& surfaces, const Light& light, const LightState& lightState,
                                     const std::vector<uint8_t>& counted)
{
    const FlatScene flat(scene, state, camera.eye);
    const uint32_t width = surfaces.depth.width, height = surfaces.depth.height;
    const gpu::ViewConstants view = viewConstants(scene, camera, {width, height});
    const gpu::LightConstants constants = lightConstants(light, lightState, camera.eye);
    std::vector<uint8_t> out(counted.size(), 0);
    std::vector<ShadowRay> rays;
    std::vector<size_t> pixels;
    std::vector<uint8_t> occluded;
    for (uint32_t y = 0; y < height; ++y) { // a row at a time
        rays.clear();
        pixels.clear();
        for (uint32_t x = 0; x < width; ++x) {
            const size_t i = size_t(y) * width + x;
            if (counted[i] != 1) continue;
            const float* n = surfaces.normals.at(x, y);
            for (size_t variant = 0; variant < kVariants; ++variant)
                rays.push_back(rayOf(view, constants, {float(x) + 0.5f, float(y) + 0.5f}, *surfaces.depth.at(x, y),
                                     {n[0], n[1], n[2]}, variant));
            pixels.push_back(i);
        }
        occluded.resize(rays.size());
        flat.rays.occluded(rays, ~0u, occluded);
        for (size_t k = 0; k < pixels.size(); ++k)
            for (size_t variant = 1; variant < kVariants; ++variant)
                out[pixels[k]] |= occluded[k * kVariants + variant] != occluded[k * kVariants];
    }
    return out;
}

} // namespace gnomon::demo

#else

namespace gnomon::demo {

std::vector<uint8_t> ambiguousPixels(const Scene&, const SceneState&, const CameraMatrices&, const FrameSurfaces&,
                                     const Light&, const LightState&, const std::vector<uint8_t>&)
{
    return {};
}

} // namespace gnomon::demo

#endif
