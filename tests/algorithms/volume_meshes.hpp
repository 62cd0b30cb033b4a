#pragma once
// Meshes, casters and lights for tests of shadow volumes, and what a segment meets in them, in double precision.
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/scene_view.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon::test {

struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
};

inline Mesh torus(float ring, float tube, std::uint32_t ringSegments, std::uint32_t tubeSegments)
{
    Mesh mesh;
    for (std::uint32_t i = 0; i < ringSegments; ++i) {
        for (std::uint32_t j = 0; j < tubeSegments; ++j) {
            const float u = 6.2831853f * static_cast<float>(i) / static_cast<float>(ringSegments);
            const float v = 6.2831853f * static_cast<float>(j) / static_cast<float>(tubeSegments);
            const float r = ring + tube * std::cos(v);
            mesh.positions.emplace_back(r * std::cos(u), tube * std::sin(v), r * std::sin(u));
            const auto at = [&](std::uint32_t a, std::uint32_t b) {
                return (a % ringSegments) * tubeSegments + b % tubeSegments;
            };
            const std::uint32_t quad[6] = {at(i, j),     at(i, j + 1),     at(i + 1, j),
                                           at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)};
            mesh.indices.insert(mesh.indices.end(), quad, quad + 6);
        }
    }
    return mesh;
}

/// Around the origin.
inline Mesh boxMesh(glm::vec3 half)
{
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

/// A sheet of triangles over [-1, 1]^2, waved by `height`.
inline Mesh sheet(std::uint32_t cells, float height)
{
    Mesh mesh;
    const auto n = static_cast<float>(cells);
    for (std::uint32_t y = 0; y <= cells; ++y)
        for (std::uint32_t x = 0; x <= cells; ++x) {
            const float u = 2.0f * static_cast<float>(x) / n - 1.0f, v = 2.0f * static_cast<float>(y) / n - 1.0f;
            mesh.positions.emplace_back(u, height * std::sin(5.0f * u) * std::cos(4.0f * v), v);
        }
    for (std::uint32_t y = 0; y < cells; ++y)
        for (std::uint32_t x = 0; x < cells; ++x) {
            const std::uint32_t a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
            const std::uint32_t quad[6] = {a, c, b, b, c, d};
            mesh.indices.insert(mesh.indices.end(), quad, quad + 6);
        }
    return mesh;
}

/// Leaves out every n-th triangle.
inline Mesh holed(Mesh mesh, std::size_t every)
{
    std::vector<std::uint32_t> kept;
    for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t)
        if (t % every != 0) kept.insert(kept.end(), &mesh.indices[3 * t], &mesh.indices[3 * t] + 3);
    mesh.indices = kept;
    return mesh;
}

/// Turns every n-th triangle round.
inline Mesh flipped(Mesh mesh, std::size_t every)
{
    for (std::size_t t = 0; t < mesh.indices.size() / 3; t += every)
        std::swap(mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
    return mesh;
}

/// Repeats every n-th triangle shifted to a fin on one of its edges: three faces on an edge.
inline Mesh finned(Mesh mesh, std::size_t every)
{
    const std::size_t triangles = mesh.indices.size() / 3;
    for (std::size_t t = 0; t < triangles; t += every) {
        const std::uint32_t a = mesh.indices[3 * t], b = mesh.indices[3 * t + 1];
        mesh.positions.push_back(1.3f * mesh.positions[a] + glm::vec3(0.01f, 0.2f, 0.03f));
        mesh.indices.insert(mesh.indices.end(), {a, b, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
    }
    return mesh;
}

/// Both in one mesh, the second one moved; vertices in one place are welded by the topology.
inline Mesh joined(Mesh mesh, const Mesh& second, glm::vec3 by)
{
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& position : second.positions)
        mesh.positions.push_back(position + by);
    for (const std::uint32_t index : second.indices)
        mesh.indices.push_back(first + index);
    return mesh;
}

/// A mesh with its topology as a caster, at a place.
struct Placed {
    Mesh mesh;
    Topology topology;
    MeshView view;
    Caster caster;

    Placed(Mesh source, const glm::mat3& basis, glm::vec3 translation) : mesh(std::move(source))
    {
        topology = buildTopology(mesh.positions, mesh.indices);
        view.positions = mesh.positions;
        view.indices = mesh.indices;
        view.topology = &topology;
        view.closed = topology.closed;
        view.bounds = {mesh.positions[0], mesh.positions[0]};
        for (const glm::vec3& p : mesh.positions) {
            view.bounds.lower = glm::min(view.bounds.lower, p);
            view.bounds.upper = glm::max(view.bounds.upper, p);
        }
        caster.mesh = &view;
        caster.basis = basis;
        caster.translation = translation;
        caster.mirrored = glm::determinant(basis) < 0.0f;
        caster.closed = topology.closed;
        caster.bounds = transformed(view.bounds, basis, translation);
    }
    Placed(const Placed&) = delete;

    glm::vec3 world(std::uint32_t vertex) const { return caster.basis * mesh.positions[vertex] + caster.translation; }
};

inline LightView pointLight(glm::vec3 position)
{
    LightView light;
    light.type = GN_LIGHT_TYPE_POINT;
    light.constants.positionWs = glm::vec4(position, 1.0f);
    light.constants.directionWs = glm::vec4(0.0f, 0.0f, 0.0f, -2.0f);
    light.constants.range = 1e30f;
    light.constants.type = gpu::LIGHT_POINT;
    return light;
}

inline LightView directionalLight(glm::vec3 direction)
{
    LightView light;
    light.type = GN_LIGHT_TYPE_DIRECTIONAL;
    light.constants.positionWs = glm::vec4(0.0f);
    light.constants.directionWs = glm::vec4(glm::normalize(direction), -2.0f);
    light.constants.range = 1e30f;
    light.constants.type = gpu::LIGHT_DIRECTIONAL;
    return light;
}

struct Random {
    std::mt19937 engine;
    explicit Random(std::uint32_t seed) : engine(seed) {}
    float operator()(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    glm::vec3 inBox(glm::vec3 low, glm::vec3 high)
    {
        const float x = (*this)(low.x, high.x), y = (*this)(low.y, high.y), z = (*this)(low.z, high.z);
        return {x, y, z};
    }
};

/// +1 if the segment from -> to leaves through the front of the triangle, -1 if it enters, 0 if it misses.
inline int crossing(glm::dvec3 from, glm::dvec3 to, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c)
{
    const auto volume = [](glm::dvec3 p, glm::dvec3 q, glm::dvec3 r, glm::dvec3 s) {
        return glm::dot(q - p, glm::cross(r - p, s - p));
    };
    const double below = volume(from, a, b, c), above = volume(to, a, b, c);
    if ((below > 0.0) == (above > 0.0)) return 0;
    const double ab = volume(from, to, a, b), bc = volume(from, to, b, c), ca = volume(from, to, c, a);
    if ((ab > 0.0) != (bc > 0.0) || (bc > 0.0) != (ca > 0.0)) return 0;
    return below > 0.0 ? 1 : -1;
}

} // namespace gnomon::test
