#include "algorithms/hybrid/sheet_edges.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace gnomon {

namespace {

// The light in object space is rounded to floats: each of its coordinates is off by 2^-24 of the largest, and so is
// what follows; eight times that, and four for the three axes.
constexpr double kFacingError = 0x1p-19;

/// Whether the sheet goes on across the edge.
bool goesOn(const Topology& topology, const Topology::Edge& edge, std::span<const Turned> turned)
{
    if (edge.useCount != 2) return false;
    const Topology::EdgeUse& a = topology.uses[edge.firstUse];
    const Topology::EdgeUse& b = topology.uses[edge.firstUse + 1];
    // Run in opposite ways and turned the same way, the faces lie on opposite sides.
    return turned[a.face] == turned[b.face] && turned[a.face] != Turned::edgeOn && a.sign != b.sign;
}

bool stopsLight(const Topology& topology, const Topology::Edge& edge, std::span<const Turned> turned, bool closed)
{
    if (!closed) return true;
    for (std::uint32_t i = 0; i < edge.useCount; ++i)
        if (turned[topology.uses[edge.firstUse + i].face] != Turned::towards) return true;
    return false;
}

void keep(const Topology& topology, const Topology::Edge& edge, std::uint32_t face, std::span<std::uint32_t> out)
{
    const std::uint32_t* corners = &topology.faceVerts[3 * std::size_t{face}];
    for (std::uint32_t i = 0; i < 3; ++i)
        if (corners[i] != edge.v0 && corners[i] != edge.v1) out[face / 8] |= 1u << (4 * (face % 8) + i);
}

} // namespace

void findTurned(const Topology& topology, std::span<const glm::vec3> positions, const glm::vec4& lightOs, bool mirrored,
                std::span<Turned> turned)
{
    const glm::dvec3 light(lightOs);
    const double w = static_cast<double>(lightOs.w);
    for (std::size_t face = 0; face < turned.size(); ++face) {
        const std::uint32_t* corners = &topology.faceVerts[3 * face];
        const glm::dvec3 a(positions[corners[0]]), b(positions[corners[1]]), c(positions[corners[2]]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double side = glm::dot(normal, light - w * a);
        const double error = kFacingError * glm::length(normal) * (glm::length(light) + std::abs(w) * glm::length(a));
        turned[face] = std::abs(side) <= error    ? Turned::edgeOn
                       : (side > 0.0) == mirrored ? Turned::away
                                                  : Turned::towards;
    }
}

void writeSheetEdges(const Topology& topology, std::span<const Turned> turned, bool closed,
                     std::span<std::uint32_t> out)
{
    std::uint32_t next = kSheetListHeader;
    for (const Topology::Edge& edge : topology.edges) {
        if (!stopsLight(topology, edge, turned, closed) || goesOn(topology, edge, turned)) continue;
        out[next++] = edge.v0;
        out[next++] = edge.v1;
        out[next++] = edge.v1;
    }
    const std::uint32_t command[kSheetListHeader] = {next - kSheetListHeader, 1, kSheetListHeader, 0, 0, 0};
    std::copy_n(command, kSheetListHeader, out.begin());
}

void setKeptEdges(const Topology& topology, std::span<const Turned> turned, std::span<std::uint32_t> out)
{
    std::fill(out.begin(), out.end(), 0u);
    for (const Topology::Edge& edge : topology.edges) {
        if (edge.useCount != 2) continue;
        const std::uint32_t a = topology.uses[edge.firstUse].face, b = topology.uses[edge.firstUse + 1].face;
        if (turned[b] == Turned::away) keep(topology, edge, a, out);
        if (turned[a] == Turned::away) keep(topology, edge, b, out);
    }
}

} // namespace gnomon
