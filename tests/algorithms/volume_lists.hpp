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
        constexpr std::uint32_t piece = 37;
        const Topology& topology = placed.topology;
        const auto faces = static_cast<std::uint32_t>(topology.facePlanes.size());
        const auto edges = static_cast<std::uint32_t>(topology.edges.size());
        const gpu::FaceLight os = lightInObjectSpace(light, placed.caster);
        facing.resize(faces);
        for (std::uint32_t first = 0; first < faces; first += piece)
            findFacing(topology, os, first, std::span(facing).subspan(first, std::min(piece, faces - first)));
        std::vector<std::uint32_t> out;
        for (std::uint32_t first = 0; first < edges; first += piece) {
            const std::uint32_t count = std::min(piece, edges - first);
            out.assign(sideCapacity(topology, first, count), 0);
            const std::uint32_t written = writeSides(topology, facing, first, count, out.data());
            REQUIRE(written <= out.size());
            sides.insert(sides.end(), out.begin(), out.begin() + written);
        }
        for (std::uint32_t first = 0; first < faces; first += piece) {
            const std::uint32_t count = std::min(piece, faces - first);
            out.assign(capCapacity(count), 0);
            const std::uint32_t written = writeCaps(topology, facing, placed.caster.mirrored, first, count, out.data());
            REQUIRE(written <= out.size());
            caps.insert(caps.end(), out.begin(), out.begin() + written);
        }
    }
};

} // namespace gnomon::test
