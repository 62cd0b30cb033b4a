#pragma once
// All edges and faces of a mesh in the form of shaders/volumes/all_edges.h; plain CPU code without Vulkan calls.
#include <cstdint>
#include <span>

#include "runtime/scene/topology.hpp"

namespace gnomon {

/// Commands of each cluster, and of the whole mesh: pairs of faces at an edge, faces that are alone at one, caps.
enum EdgeCommand : std::uint32_t { kPairCommand, kBorderCommand, kCapCommand, kEdgeCommands };

/// Where a command of a cluster is in the list; those of the whole mesh come last.
inline std::uint32_t commandOf(std::uint32_t cluster, EdgeCommand command)
{
    return kEdgeCommands * cluster + command;
}

/// Sizes of a list; those of open meshes are upper bounds that need no look at the edges.
struct EdgeListSize {
    std::uint64_t records = 0; ///< Pairs and borders.
    std::uint64_t faces = 0;
    std::uint64_t clusters = 1;

    std::uint64_t indices() const { return 6 * (records + faces); }
    std::uint64_t commandWords() const; ///< Of 4 bytes.
    std::uint64_t firstSlot() const;    ///< In units of 16 bytes.
    std::uint64_t slots() const { return records + 2 * faces; }
    std::uint64_t bytes() const { return 16 * (firstSlot() + slots()); }
    std::uint64_t largestIndex() const { return 8 * (firstSlot() + slots()); }
};
EdgeListSize edgeListSize(const Topology& topology);

/// Writes the list: words of 4 bytes, edgeListSize().bytes() in all.
void writeEdgeList(const Topology& topology, std::span<std::uint32_t> out);

} // namespace gnomon
