#pragma once
// Meshes of every kind, placed in every way, and their volumes as the CPU and as a device has them: for tests of
// silhouettes, sides and caps.
#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "algorithms/volumes/edge_list.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "shaders/volumes/all_edges.h"
#include "shaders/volumes/volume.h"
#include "tests/algorithms/volume_lists.hpp"

namespace gnomon::test {

/// What a device draws of the list of all edges and faces, as indices of the same kind.
struct DeviceLists {
    std::vector<std::uint32_t> sides, caps;
    std::size_t sidesLookedAt = 0;

    DeviceLists(const Placed& placed, const LightView& light)
        : placed_(placed), light_(lightInObjectSpace(light, placed.caster)),
          words_(edgeListSize(placed.topology).bytes() / 4)
    {
        writeEdgeList(placed.topology, words_);
        for (std::uint32_t cluster = 0; cluster < placed.topology.clusters.size(); ++cluster) {
            closed_ = placed.topology.clusters[cluster].closed;
            light_.touched = touchedWay(closed_, placed.caster.mirrored);
            const std::size_t before = looked_;
            for (const EdgeCommand command : {kPairCommand, kBorderCommand})
                draw(cluster, command, sides);
            sidesLookedAt += looked_ - before;
            draw(cluster, kCapCommand, caps);
        }
        REQUIRE(largest_ < edgeListSize(placed.topology).largestIndex());
    }

private:
    gpu::uvec4 slot(std::uint32_t index) const
    {
        REQUIRE(4 * index + 3 < words_.size());
        return {words_[4 * index], words_[4 * index + 1], words_[4 * index + 2], words_[4 * index + 3]};
    }
    std::uint32_t wayOf(std::uint32_t plane) const
    {
        const gpu::uvec4 bits = slot(plane);
        const glm::vec4 values(std::bit_cast<float>(bits.x), std::bit_cast<float>(bits.y), std::bit_cast<float>(bits.z),
                               std::bit_cast<float>(bits.w));
        return gpu::faceWay(values, light_);
    }
    std::uint32_t sideAt(std::uint32_t index, std::uint32_t instance) const
    {
        const gpu::uvec4 edge = slot(index >> 2);
        return gpu::sideCorner(edge, wayOf(edge.z >> 1), wayOf(edge.w >> 1), instance, index & 3);
    }
    std::uint32_t capAt(std::uint32_t index) const
    {
        const std::uint32_t away = placed_.caster.mirrored ? gpu::FACE_TOWARDS : gpu::FACE_AWAY;
        const gpu::uvec4 face = slot(index >> 3);
        return gpu::capCorner(face, wayOf(face.w), closed_ ? away : gpu::FACE_TOUCHED, (index >> 2) & 1, index & 3);
    }
    void draw(std::uint32_t cluster, EdgeCommand command, std::vector<std::uint32_t>& out)
    {
        const std::uint32_t* words = &words_[std::size_t{5} * commandOf(cluster, command)];
        const std::uint32_t count = words[0], instances = words[1], first = words[2];
        REQUIRE(first + count <= words_.size());
        for (std::uint32_t instance = 0; instance < instances; ++instance)
            for (std::uint32_t i = first; i < first + count; i += 6) {
                std::array<std::uint32_t, 6> corners{};
                for (std::uint32_t k = 0; k < 6; ++k) {
                    largest_ = std::max<std::uint64_t>(largest_, words_[i + k]);
                    corners[k] = command == kCapCommand ? capAt(words_[i + k]) : sideAt(words_[i + k], instance);
                }
                ++looked_;
                const auto gone = std::count(corners.begin(), corners.end(), gpu::NO_CORNER);
                CHECK((gone == 0 || gone == 6));
                if (gone == 0) out.insert(out.end(), corners.begin(), corners.end());
            }
    }

    const Placed& placed_;
    gpu::FaceLight light_;
    bool closed_ = false; ///< The cluster that is drawn.
    std::vector<std::uint32_t> words_;
    std::size_t looked_ = 0;
    std::uint64_t largest_ = 0;
};

using SixCorners = std::array<std::uint32_t, 6>;

/// How often each six indices occur.
inline std::map<SixCorners, int> counted(const std::vector<std::uint32_t>& indices)
{
    std::map<SixCorners, int> counts;
    for (std::size_t i = 0; i < indices.size(); i += 6) {
        SixCorners corners{};
        std::copy_n(&indices[i], 6, corners.begin());
        ++counts[corners];
    }
    return counts;
}

/// How often each directed edge has a side, less how often the same one has it the other way round.
inline std::map<std::pair<std::uint32_t, std::uint32_t>, int> sums(const std::vector<std::uint32_t>& sides)
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sum;
    for (std::size_t i = 0; i < sides.size(); i += 6) {
        const std::uint32_t a = sides[i], b = sides[i + 5];
        sum[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
    std::erase_if(sum, [](const auto& entry) { return entry.second == 0; });
    return sum;
}

/// Whether as many sides leave every vertex as come to it.
inline bool loopsAreClosed(const std::vector<std::uint32_t>& sides)
{
    std::map<std::uint32_t, int> balance; // edges out minus edges in, by vertex
    for (std::size_t i = 0; i < sides.size(); i += 6) {
        CHECK(sides[i] % 2 == 0);
        CHECK(sides[i + 5] % 2 == 0);
        ++balance[sides[i]];
        --balance[sides[i + 5]];
    }
    return std::all_of(balance.begin(), balance.end(), [](const auto& entry) { return entry.second == 0; });
}

/// A caster's volume as triangles in the world.
struct Volume {
    std::vector<glm::dvec3> corners; ///< By index: 2 * vertex + copy.
    glm::vec4 plane;

    Volume(const Placed& placed, const LightView& light, const Aabb& box)
    {
        const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
        const glm::vec4 l = directional ? glm::vec4(light.direction(), 0.0f) : glm::vec4(light.position(), 1.0f);
        constexpr float beyond = 1e-3f; // points of the box may lie on its sides
        plane = gpu::extrusionPlane(l, casterReach(placed.caster.bounds, light, glm::vec3(0.0f)), box.lower - beyond,
                                    box.upper + beyond);
        for (std::uint32_t v = 0; v < placed.mesh.positions.size(); ++v) {
            const glm::vec3 near = placed.world(v);
            const glm::vec4 moved = gpu::extruded(near, l, plane);
            corners.emplace_back(near);
            corners.emplace_back(glm::dvec3(moved) / static_cast<double>(moved.w));
        }
    }

    /// Moved by a length that stands for infinity.
    Volume(const Placed& placed, glm::dvec3 lamp)
    {
        for (std::uint32_t v = 0; v < placed.mesh.positions.size(); ++v) {
            corners.emplace_back(placed.world(v));
            corners.emplace_back(lamp + 1e5 * (corners.back() - lamp));
        }
    }

    int crossings(std::span<const std::uint32_t> indices, glm::dvec3 from, glm::dvec3 to) const
    {
        int sum = 0;
        for (std::size_t i = 0; i < indices.size(); i += 3)
            sum += crossing(from, to, corners[indices[i]], corners[indices[i + 1]], corners[indices[i + 2]]);
        return sum;
    }
};

/// Faces that a segment meets; `chosen` says which count.
template <typename Chosen>
int facesBetween(const Placed& placed, glm::dvec3 from, glm::dvec3 to, Chosen&& chosen)
{
    int count = 0;
    for (std::uint32_t face = 0; face < placed.topology.facePlanes.size(); ++face) {
        const std::uint32_t* v = &placed.topology.faceVerts[3 * face];
        if (chosen(face) && crossing(from, to, placed.world(v[0]), placed.world(v[1]), placed.world(v[2])) != 0)
            ++count;
    }
    return count;
}

struct Case {
    const char* name;
    Mesh mesh;
    bool closed;
};

inline std::vector<Case> cases()
{
    const Mesh ring = torus(1.0f, 0.35f, 14, 9);
    Mesh twice = ring; // every edge four times: closed, yet not manifold
    twice.indices.insert(twice.indices.end(), ring.indices.begin(), ring.indices.end());
    return {{"torus", ring, true},
            {"torus twice", twice, true},
            {"torus inside out", flipped(ring, 1), false},
            {"holed torus", holed(ring, 5), false},
            {"torus with flipped faces", flipped(ring, 7), false},
            {"torus with fins", finned(ring, 11), false},
            {"sheet", sheet(8, 0.3f), false},
            {"sheet with flipped faces and fins", finned(flipped(sheet(8, 0.3f), 3), 9), false},
            {"two tori apart", joined(ring, ring, {0.2f, 1.1f, 0.1f}), true},
            {"torus over a sheet", joined(sheet(8, 0.3f), ring, {0.1f, 1.0f, 0.2f}), false}};
}

inline std::vector<glm::mat3> bases()
{
    const glm::mat3 turned(glm::rotate(glm::mat4(1.0f), 0.7f, glm::normalize(glm::vec3(1, 2, 3))));
    return {turned, turned * glm::mat3(1, 0, 0, 0, -1, 0, 0, 0, 1),  // mirrored
            turned * glm::mat3(2, 0, 0, 0.5f, 0.3f, 0, 0, 0.4f, 1)}; // scaled and sheared
}

inline const glm::vec3 kPlace(3.0f, 1.0f, -2.0f);

inline std::vector<LightView> lights()
{
    return {pointLight(kPlace + glm::vec3(2, 6, 1)), pointLight(kPlace + glm::vec3(-7, 1.5f, 3)),
            directionalLight(glm::vec3(0.3f, -1.0f, 0.2f)), directionalLight(glm::vec3(-1.0f, -0.2f, 0.5f))};
}

template <typename Body>
void forAllCases(Body&& body)
{
    for (const Case& c : cases())
        for (const glm::mat3& basis : bases())
            for (const LightView& light : lights()) {
                CAPTURE(std::string(c.name));
                CAPTURE(glm::determinant(basis));
                CAPTURE(static_cast<int>(light.type));
                const Placed placed(c.mesh, basis, kPlace);
                REQUIRE(placed.topology.closed == c.closed);
                body(placed, light);
            }
}

inline const Aabb kBox{kPlace - 5.0f, kPlace + 5.0f};

} // namespace gnomon::test
