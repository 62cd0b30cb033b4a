#pragma once
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "runtime/scene/topology.hpp"

namespace gnomon {

inline constexpr std::uint32_t kMostClusters = 256;

/// Edges with more uses keep all their faces together: telling them apart takes the square of their number.
inline constexpr std::uint32_t kMostUses = 64;

/// Cuts a mesh into its clusters, but for their bounds, and puts edges and faces in their order. Shells, faces that
/// hang together, are never cut; they are in one cluster unless boxes around two halves, weighted by their mean sides, are
/// that much smaller than the box around both (the surface area heuristic: MacDonald and Booth, "Heuristics for ray
/// tracing using space subdivision", Visual Computer 6, 1990), the greatest gains first. Clusters come in the order of
/// their first faces.
///
/// Faces hang together by an edge that two of them use. Where more meet, as where boxes touch, each solid is a shell,
/// and the edge is there once for each cluster.
/// @pre edges, uses, faceVerts and facePlanes are there
void makeClusters(Topology& topology, std::span<const glm::vec3> positions);

} // namespace gnomon
