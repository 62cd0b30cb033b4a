#pragma once
// The index lists of a caster, for tests of shadow volumes.
#include <algorithm>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "algorithms/volumes/silhouette.hpp"
#include "tests/algorithms/volume_meshes.hpp"

namespace gnomon::test {

/// The index lists of one caster and light, as the prepare pass makes them, in pieces of an odd size.
struct Lists {
    std::vector<std::uint8_t> facing;
    std::vector<std::uint32_t> sides, caps;

    Lists(const Placed& placed, const LightView& light)
    {
        const Topology& topology = placed.topology;
        const auto faces = static_cast<std::uint32_t>(topology.facePlanes.size());
        const gpu::FaceLight os = lightInObjectSpace(light, placed.caster);
        facing.resize(faces);
        for (std::uint32_t first = 0; first < faces; first += kPiece) {
            const std::span<std::uint8_t> out = std::span(facing).subspan(first, std::min(kPiece, faces - first));
            findFacing(topology, os, first, out);
            faceByCluster(topology, placed.caster.mirrored, first, out);
        }
        for (const Topology::Cluster& cluster : topology.clusters)
            append(placed, cluster);
    }
    /// Whether the volume of its cluster counts the face.
    bool blocks(const Placed& placed, std::uint32_t face) const
    {
        return blocksLight(placed.topology.clusterOf(face).closed, facing[face], placed.caster.mirrored);
    }

private:
    static constexpr std::uint32_t kPiece = 37;

    void append(const Placed& placed, const Topology::Cluster& cluster)
    {
        const Topology& topology = placed.topology;
        std::vector<std::uint32_t> out;
        const std::uint32_t edgesEnd = cluster.firstEdge + cluster.edgeCount;
        for (std::uint32_t first = cluster.firstEdge; first < edgesEnd; first += kPiece) {
            const std::uint32_t count = std::min(kPiece, edgesEnd - first);
            out.assign(sideCapacity(topology, cluster, first, count), 0);
            const std::uint32_t written = writeSides(topology, cluster, facing, first, count, out.data());
            REQUIRE(written <= out.size());
            sides.insert(sides.end(), out.begin(), out.begin() + written);
        }
        const std::uint32_t facesEnd = cluster.firstFace + cluster.faceCount;
        for (std::uint32_t first = cluster.firstFace; first < facesEnd; first += kPiece) {
            const std::uint32_t count = std::min(kPiece, facesEnd - first);
            out.assign(capCapacity(count), 0);
            const std::uint32_t written =
                writeCaps(topology, cluster.closed, facing, placed.caster.mirrored, first, count, out.data());
            REQUIRE(written <= out.size());
            caps.insert(caps.end(), out.begin(), out.begin() + written);
        }
    }
};

} // namespace gnomon::test
