#pragma once
// Silhouettes and caps of one caster as index lists; plain CPU code without Vulkan.
//
// An index is 2 * vertex + copy: copy 0 is the caster's vertex, copy 1 the one moved away from the light
// (shaders/volumes/volume.vert). Triangles wind counter-clockwise seen from outside the volume, in world space.
#include <cstdint>
#include <span>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/face_light.hpp"
#include "runtime/scene/scene_view.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon {

/// facing[i] = way of face first + i (FACE_TOWARDS, ...).
void findFacing(const Topology& topology, const gpu::FaceLight& light, std::uint32_t first,
                std::span<std::uint8_t> facing);

/// Turns ways of faces that touch the light into those they have in their clusters, where some of an open mesh are
/// closed: clusters have volumes of their own.
void faceByCluster(const Topology& topology, bool mirrored, std::uint32_t first, std::span<std::uint8_t> facing);

/// Whether a face stops light: of a closed mesh or cluster those turned away from it, where light would leave the solid
/// (a lit surface then never shades itself), of an open one all but those that it touches.
inline bool blocksLight(bool closed, std::uint8_t facing, bool mirrored)
{
    if (!closed) return facing != gpu::FACE_TOUCHED;
    return facing == (mirrored ? gpu::FACE_TOWARDS : gpu::FACE_AWAY); // mirroring turns a closed mesh inside out
}

// Ranges of edges below, and of places of faces, lie within one cluster.

/// Most indices writeSides can write for these edges.
std::uint32_t sideCapacity(const Topology& topology, const Topology::Cluster& cluster, std::uint32_t firstEdge,
                           std::uint32_t count);

/// An edge of the silhouette in the direction of its sign: the outside lies to its right, seen from the light.
struct SilhouetteEdge {
    std::uint32_t from, to; ///< Vertices.
    std::uint32_t times;    ///< Its signed multiplicity; closed clusters: half of it (see stencil_volume.md).
};

/// Finds the silhouette among these edges. @param facing of all faces. @param out has room for `count`.
/// @return how many it are.
std::uint32_t findSilhouette(const Topology& topology, const Topology::Cluster& cluster,
                             std::span<const std::uint8_t> facing, std::uint32_t firstEdge, std::uint32_t count,
                             SilhouetteEdge* out);
/// Writes the sides under silhouette edges. @return indices written.
std::uint32_t writeSides(std::span<const SilhouetteEdge> edges, std::uint32_t* out);

/// Both: every edge as often, and in that direction, as its signed multiplicity says.
/// @param facing of all faces. @return indices written.
std::uint32_t writeSides(const Topology& topology, const Topology::Cluster& cluster,
                         std::span<const std::uint8_t> facing, std::uint32_t firstEdge, std::uint32_t count,
                         std::uint32_t* out);

/// Most indices writeCaps can write for this many faces.
inline std::uint32_t capCapacity(std::uint32_t faceCount)
{
    return faceCount * 6;
}

/// Writes near and far caps that close the sides: the faces of blocksLight(), oriented towards the light.
/// @param closed as blocksLight(). @param facing of all faces. @param mirrored as Caster::mirrored. @param firstPlace
/// for Topology::faceAt() @return indices written.
std::uint32_t writeCaps(const Topology& topology, bool closed, std::span<const std::uint8_t> facing, bool mirrored,
                        std::uint32_t firstPlace, std::uint32_t count, std::uint32_t* out);

} // namespace gnomon
