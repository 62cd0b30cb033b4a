#pragma once
// Meshes and casters for tests that trace, without a device or a registry.
#include <memory>
#include <random>
#include <vector>

#include "runtime/rays/ray_scene.hpp"
#include "runtime/scene/scene_view.hpp"
#include "tests/runtime/light_fixture.hpp"

namespace gnomon::test {

/// A mesh with its tree. The positions have one spare element: trees read 16 bytes a vertex.
struct TracedMesh {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices; ///< Empty if shared.
    std::unique_ptr<MeshRays> rays;
    MeshView view;

    TracedMesh(RayScene& scene, std::vector<glm::vec3> corners, std::vector<std::uint32_t> triangles = {})
        : positions(std::move(corners)), indices(std::move(triangles))
    {
        for (std::uint32_t i = 0; indices.size() < positions.size() && i < positions.size(); ++i)
            indices.push_back(i);
        build(scene, indices, nullptr);
    }
    /// A revision. @param shared outlives history and mesh
    TracedMesh(RayScene& scene, std::vector<glm::vec3> corners, std::span<const std::uint32_t> shared,
               MeshRaysHistory& history)
        : positions(std::move(corners))
    {
        build(scene, shared, &history);
    }

private:
    void build(RayScene& scene, std::span<const std::uint32_t> triangles, MeshRaysHistory* history)
    {
        const std::size_t count = positions.size();
        positions.emplace_back(0.0f); // Embree reads 16 bytes a corner
        view.positions = std::span<const glm::vec3>(positions).first(count);
        view.indices = triangles;
        rays = scene.build(view.positions, triangles, history);
        view.rays = rays.get();
        static std::uint64_t revision = 0;
        view.revision = ++revision;
    }
};

inline Caster casterOf(const TracedMesh& mesh, std::uint32_t id, const glm::mat3& basis = glm::mat3(1.0f),
                       glm::vec3 translation = glm::vec3(0.0f))
{
    Caster caster;
    caster.index = caster.id = id;
    caster.mesh = &mesh.view;
    caster.basis = basis;
    caster.translation = translation;
    return caster;
}

inline glm::vec3 randomPoint(std::mt19937& random, float halfSize)
{
    std::uniform_real_distribution<float> coordinate(-halfSize, halfSize);
    const float x = coordinate(random), y = coordinate(random), z = coordinate(random);
    return {x, y, z};
}

/// Small triangles anywhere in a cube.
inline std::vector<glm::vec3> randomTriangles(std::mt19937& random, std::size_t count, float halfSize, float size)
{
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 center = randomPoint(random, halfSize);
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back(center + randomPoint(random, size));
    }
    return corners;
}

/// From anywhere in a cube to anywhere in it.
inline std::vector<ShadowRay> randomRays(std::mt19937& random, std::size_t count, float halfSize)
{
    std::vector<ShadowRay> rays(count);
    for (ShadowRay& ray : rays) {
        ray.origin = randomPoint(random, halfSize);
        ray.direction = randomPoint(random, halfSize) - ray.origin;
        ray.tfar = 1.0f;
    }
    return rays;
}

inline std::vector<std::uint8_t> trace(const RayScene& scene, const std::vector<ShadowRay>& rays,
                                       std::uint32_t mask = 0xffffffffu)
{
    std::vector<std::uint8_t> occluded(rays.size(), 0xcc);
    scene.occluded(rays, mask, occluded);
    return occluded;
}

} // namespace gnomon::test
