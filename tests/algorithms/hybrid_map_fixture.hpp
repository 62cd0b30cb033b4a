#pragma once
// A map of depth and triangle numbers drawn in double precision, triangle by triangle: what the device leaves in a copy
// of its map, for the scene of hybrid_fixture.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/mat4x4.hpp>

#include "algorithms/hybrid/candidate_occluder.hpp"
#include "algorithms/hybrid/map_texels.hpp"
#include "algorithms/hybrid_fixture.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "runtime/scene/light_fit.hpp"

namespace gnomon::test {

struct DrawnMap {
    std::uint32_t side = 0;
    std::vector<LightFit> fits;
    std::array<std::vector<float>, 6> depth;
    std::array<std::vector<std::uint32_t>, 6> numbers;

    HostMap view() const
    {
        HostMap map{.side = side, .depth = {}, .triangle = {}};
        for (std::size_t layer = 0; layer < fits.size(); ++layer) {
            map.depth[layer] = depth[layer];
            map.triangle[layer] = numbers[layer];
        }
        return map;
    }
};

/// A triangle in texels, z the depth: every texel whose centre it covers, both sides, pushed away by its slope as open
/// casters are (runtime/scene/bias.hpp).
inline void fill(DrawnMap& map, std::size_t layer, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                 std::uint32_t number)
{
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    if (normal.z == 0.0) return;
    const double dx = -normal.x / normal.z, dy = -normal.y / normal.z;
    const double bias = std::max(std::abs(dx), std::abs(dy)) + 0x1p-22;
    const auto clamped = [&](double v) { return static_cast<int>(std::clamp(v, 0.0, double(map.side))); };
    const int left = clamped(std::floor(std::min({a.x, b.x, c.x}))),
              top = clamped(std::floor(std::min({a.y, b.y, c.y})));
    const int right = clamped(std::ceil(std::max({a.x, b.x, c.x}))),
              bottom = clamped(std::ceil(std::max({a.y, b.y, c.y})));
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
            const glm::dvec3 at(x + 0.5, y + 0.5, 0.0);
            const auto edge = [&](const glm::dvec3& from, const glm::dvec3& to) {
                return ((to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x)) * normal.z >= 0.0;
            };
            if (!edge(a, b) || !edge(b, c) || !edge(c, a)) continue;
            const double z = a.z + dx * (at.x - a.x) + dy * (at.y - a.y) + bias;
            const std::size_t place = std::size_t(y) * map.side + std::size_t(x);
            if (!(z < double(map.depth[layer][place]))) continue;
            map.depth[layer][place] = std::max(static_cast<float>(z), 0.0f);
            map.numbers[layer][place] = number;
        }
}

/// Cuts off what lies behind the light.
inline void project(DrawnMap& map, std::size_t layer, const std::array<glm::dvec4, 3>& clip, std::uint32_t number)
{
    constexpr double nearest = 1e-4;
    std::vector<glm::dvec4> kept;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec4 &from = clip[i], &to = clip[(i + 1) % 3];
        if (from.w > nearest) kept.push_back(from);
        if ((from.w > nearest) != (to.w > nearest))
            kept.push_back(from + (nearest - from.w) / (to.w - from.w) * (to - from));
    }
    const auto texel = [&](const glm::dvec4& p) {
        const glm::dvec3 ndc = glm::dvec3(p) / p.w;
        return glm::dvec3(0.5 * map.side * (ndc.x + 1.0), 0.5 * map.side * (ndc.y + 1.0), ndc.z);
    };
    for (std::size_t i = 2; i < kept.size(); ++i)
        fill(map, layer, texel(kept[0]), texel(kept[i - 1]), texel(kept[i]), number);
}

inline DrawnMap drawMap(const LightView& light, std::span<const Caster* const> casters, std::uint32_t side)
{
    DrawnMap map{.side = side, .fits = {}, .depth = {}, .numbers = {}};
    LightCasters lit;
    lit.all = lit.statics = casters;
    const Aabb bounds = sceneBounds(lit);
    if (light.type == GN_LIGHT_TYPE_POINT) {
        for (std::uint32_t face = 0; face < 6; ++face)
            map.fits.push_back(fitCubeFace(light, bounds, face, side, 4.0f));
    } else {
        map.fits.push_back(light.type == GN_LIGHT_TYPE_SPOT ? fitSpot(light, bounds) : fitDirectional(light, bounds));
    }
    for (std::size_t layer = 0; layer < map.fits.size(); ++layer) {
        map.depth[layer].assign(std::size_t(side) * side, 1.0f);
        map.numbers[layer].assign(std::size_t(side) * side, kNoTriangle);
        const glm::dmat4 clipFromWorld(map.fits[layer].clipFromWorld);
        std::uint32_t number = 0;
        for (const Caster* caster : casters) {
            const MeshView& mesh = *caster->mesh;
            for (std::uint32_t i = 0; i < mesh.triangleCount(); ++i, ++number) {
                std::array<glm::dvec4, 3> clip;
                for (std::size_t c = 0; c < 3; ++c) {
                    const glm::vec3 p = mesh.positions[mesh.indices[3 * i + c]];
                    const glm::dvec3 world =
                        glm::dmat3(caster->basis) * glm::dvec3(p) + glm::dvec3(caster->translation);
                    clip[c] = clipFromWorld * glm::dvec4(world, 1.0);
                }
                project(map, layer, clip, number);
            }
        }
    }
    return map;
}

} // namespace gnomon::test
