#pragma once
// A caster as the ray tracer's top level has it. Internal to this folder, as it includes Embree's header.
#include <cstdint>
#include <span>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/rays/mesh_rays.hpp"
#include "runtime/scene/long_edges.hpp"

namespace gnomon {

/// A caster in the top level. Its index in the table is Embree's geometry id.
struct Placed {
    RTCGeometry geometry = nullptr; ///< Null: the entry is free.
    std::uint32_t id = 0;           ///< Caster::id
    const MeshRays* rays = nullptr;
    std::uint64_t meshRevision = 0; ///< Trees may reuse an address; revisions are unique.
    glm::mat3 basis{0.0f};
    glm::vec3 translation{0.0f};
    std::uint32_t mask = 0;
    PFN_gnOpacity opacity = nullptr;
    void* userData = nullptr;
    std::span<const std::uint32_t> givenNumbers; ///< MeshView::givenNumbers
    std::span<const glm::vec3> positions;        ///< MeshView's, as are the indices.
    std::span<const std::uint32_t> indices;
    bool turned = false;    ///< MeshView::turned
    bool isLong = false;    ///< isLong() (long_edges.hpp).
    float reach = 0.0f;     ///< reachOf()
    std::uint64_t seen = 0; ///< The last update() that brought it.

    /// What the host says of a hit; its triangles are numbered as it gave them.
    float opacityAt(std::uint32_t triangle, float u, float v) const
    {
        if (turned) std::swap(u, v);
        return opacity(givenNumbers.empty() ? triangle : givenNumbers[triangle], u, v, userData);
    }
    /// startsOn(), of a ray in object space.
    bool isStartedOn(std::uint32_t triangle, const glm::dvec3& start) const
    {
        const glm::dmat3 toWorld(basis);
        glm::dvec3 corners[3];
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = toWorld * glm::dvec3(positions[indices[3 * std::size_t(triangle) + i]]);
        return startsOn(corners, toWorld * start);
    }
};

inline bool unchanged(const Placed& placed, const Caster& caster)
{
    return placed.rays == caster.mesh->rays && placed.meshRevision == caster.mesh->revision &&
           placed.basis == caster.basis && placed.translation == caster.translation && placed.mask == caster.mask &&
           placed.opacity == opacityOf(caster) && placed.userData == caster.userData;
}

} // namespace gnomon
