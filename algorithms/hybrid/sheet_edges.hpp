#pragma once
// Where the sheets of a mesh end, seen from a light: edges at which the faces that stop light do not go on to the other
// side. Plain CPU code without Vulkan.
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/scene/topology.hpp"

namespace gnomon {

/// How a face lies to the light.
enum class Turned : std::uint8_t {
    towards, ///< As wound, in the world.
    away,
    edgeOn, ///< To within rounding: neither.
};

/// Of all faces. @param lightOs lightInObjectSpace().at @param mirrored as Caster::mirrored: winding is reversed, and
/// "towards" is meant of the surface's outside.
void findTurned(const Topology& topology, std::span<const glm::vec3> positions, const glm::vec4& lightOs, bool mirrored,
                std::span<Turned> turned);

/// Words of a list for that many edges: an indirect command, then three vertices an edge, the second one twice.
inline constexpr std::uint32_t kSheetListHeader =
    6; ///< A multiple of three: vertices are counted from the list's start.
constexpr std::uint64_t sheetListWords(std::uint64_t edges)
{
    return kSheetListHeader + 3 * edges;
}

/// Writes the borders of all sheets: of a closed mesh those of faces turned away, of an open one those of both sides.
/// Edges go on only between exactly two faces that turn the same way and lie on opposite sides of it.
void writeSheetEdges(const Topology& topology, std::span<const Turned> turned, bool closed,
                     std::span<std::uint32_t> out);

/// Four bits a face: bit i, the neighbour across the edge opposite to corner i is turned away from the light, and alone
/// there (Morais 2015, 4: such an edge stays in place).
constexpr std::uint64_t keptEdgeWords(std::uint64_t faces)
{
    return (faces + 7) / 8;
}
/// @param out is read as well: no upload memory
void setKeptEdges(const Topology& topology, std::span<const Turned> turned, std::span<std::uint32_t> out);

} // namespace gnomon
