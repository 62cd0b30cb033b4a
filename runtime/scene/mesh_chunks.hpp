#pragma once
// Which triangles of a caster a part of space can hold. Meshes are seldom cut where lights end: a landscape, or a
// building in one piece, reaches past most of them. What lies together in space mostly does so in the index buffer, as
// exporters and optimisers of vertex caches leave it, so bounds of a few hundred triangles in a row are small.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Triangles with bounds of their own. On lavapipe a draw takes 0.6 us and 100 000 vertices 3 ms: a chunk, with half as
/// many vertices as triangles, takes as long as 13 draws, so that one more draw for one left out pays. Of a million
/// triangles 1 954 chunks are asked.
inline constexpr std::uint32_t kChunkFaces = 512;

/// Object-space bounds of every kChunkFaces triangles in their order; of all that are left in the last.
/// @param indices three a triangle, in range
std::vector<Aabb> chunkBounds(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

/// The most that an edge of any triangle goes along each axis, object space.
glm::vec3 edgeSpan(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

/// Triangles of a mesh, by their order.
struct FaceRange {
    std::uint32_t first = 0, end = 0; ///< `end` is none of them.
};

/// Calls visit(FaceRange) with the triangles of a caster that may touch the volume, in their order and in as few ranges
/// as chunks make. @param among those that are asked for
template <typename Visit>
void forFacesIn(std::span<const Plane> volume, const Caster& caster, FaceRange among, const Visit& visit)
{
    const std::span<const Aabb> chunks = caster.mesh->chunks;
    among.end = std::min(among.end, caster.mesh->triangleCount());
    if (among.first >= among.end) return;
    if (chunks.size() < 2 || caster.gpuPlaced || holds(volume, caster.bounds)) return visit(among);
    FaceRange run{among.first, among.first};
    for (std::uint32_t first = among.first; first < among.end;) {
        const std::uint32_t chunk = first / kChunkFaces, end = std::min((chunk + 1) * kChunkFaces, among.end);
        if (touches(transformed(chunks[chunk], caster.basis, caster.translation), volume)) {
            if (run.end < first) {
                if (run.first < run.end) visit(run);
                run.first = first;
            }
            run.end = end;
        }
        first = end;
    }
    if (run.first < run.end) visit(run);
}

} // namespace gnomon
