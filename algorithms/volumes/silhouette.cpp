#include "algorithms/volumes/silhouette.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/volumes/facing.hpp"

namespace gnomon {

namespace {

/// The signed multiplicity: +1 per face that, turned towards the light, runs v0 -> v1, -1 per face that runs v1 -> v0.
/// Faces of a closed cluster are never FACE_TOUCHED, and not asked: that is a tenth of the time.
template <bool Closed>
int multiplicity(const Topology& topology, const Topology::Edge& edge, const std::uint8_t* facing)
{
    int sum = 0;
    for (std::uint32_t i = 0; i < edge.useCount; ++i) {
        const Topology::EdgeUse& use = topology.uses[edge.firstUse + i];
        if constexpr (Closed)
            sum += (facing[use.face] != 0) == (use.sign > 0.0f) ? 1 : -1;
        else
            sum += gpu::edgeWay(facing[use.face], use.sign > 0.0f);
    }
    return sum;
}

template <bool Closed>
SilhouetteEdge* findAmong(std::span<const Topology::Edge> edges, const Topology& topology, const std::uint8_t* facing,
                          SilhouetteEdge* out)
{
    for (const Topology::Edge& edge : edges) {
        const int sum = multiplicity<Closed>(topology, edge, facing);
        if (sum == 0) continue;
        const auto times = static_cast<std::uint32_t>(std::abs(sum)) / (Closed ? 2 : 1); // closed: always even
        *out++ = {sum > 0 ? edge.v0 : edge.v1, sum > 0 ? edge.v1 : edge.v0, times};
    }
    return out;
}

// Silhouettes found at a time: a few kilobytes beside the edges they come from.
constexpr std::uint32_t kChunk = 512;

std::uint32_t* writeQuad(std::uint32_t a, std::uint32_t b, std::uint32_t* out)
{
    // The face lies left of a -> b seen from the light, the outside to the right.
    const std::uint32_t nearA = 2 * a, farA = 2 * a + 1, nearB = 2 * b, farB = 2 * b + 1;
    const std::uint32_t corners[6] = {nearA, farA, farB, nearA, farB, nearB};
    return std::copy_n(corners, 6, out);
}

} // namespace

void findFacing(const Topology& topology, const gpu::FaceLight& light, std::uint32_t first,
                std::span<std::uint8_t> facing)
{
    findFacing(topology.facePlanes, light.at, first, facing);
    const std::uint32_t end = first + static_cast<std::uint32_t>(facing.size());
    forTouchedFaces(topology.facePlanes, light, first, end,
                    [&](std::uint32_t face) { facing[face - first] = static_cast<std::uint8_t>(light.touched); });
}

void faceByCluster(const Topology& topology, bool mirrored, std::uint32_t first, std::span<std::uint8_t> facing)
{
    if (topology.closed || topology.clusters.size() == 1) return;
    for (std::size_t i = 0; i < facing.size(); ++i)
        if (facing[i] == gpu::FACE_TOUCHED) {
            const bool closed = topology.clusterOf(first + static_cast<std::uint32_t>(i)).closed;
            facing[i] = static_cast<std::uint8_t>(touchedWay(closed, mirrored));
        }
}

std::uint32_t sideCapacity(const Topology& topology, const Topology::Cluster& cluster, std::uint32_t firstEdge,
                           std::uint32_t count)
{
    if (count == 0) return 0;
    const Topology::Edge& last = topology.edges[firstEdge + count - 1];
    const std::uint32_t uses = last.firstUse + last.useCount - topology.edges[firstEdge].firstUse;
    return 6 * (cluster.closed ? uses / 2 : uses);
}

std::uint32_t findSilhouette(const Topology& topology, const Topology::Cluster& cluster,
                             std::span<const std::uint8_t> facing, std::uint32_t firstEdge, std::uint32_t count,
                             SilhouetteEdge* out)
{
    const std::span<const Topology::Edge> edges = std::span(topology.edges).subspan(firstEdge, count);
    SilhouetteEdge* end = cluster.closed ? findAmong<true>(edges, topology, facing.data(), out)
                                         : findAmong<false>(edges, topology, facing.data(), out);
    return static_cast<std::uint32_t>(end - out);
}

std::uint32_t writeSides(std::span<const SilhouetteEdge> edges, std::uint32_t* out)
{
    std::uint32_t* end = out;
    for (const SilhouetteEdge& edge : edges)
        for (std::uint32_t i = 0; i < edge.times; ++i)
            end = writeQuad(edge.from, edge.to, end);
    return static_cast<std::uint32_t>(end - out);
}

std::uint32_t writeSides(const Topology& topology, const Topology::Cluster& cluster,
                         std::span<const std::uint8_t> facing, std::uint32_t firstEdge, std::uint32_t count,
                         std::uint32_t* out)
{
    std::uint32_t written = 0;
    SilhouetteEdge found[kChunk];
    for (std::uint32_t done = 0; done < count; done += kChunk) {
        const std::uint32_t edges =
            findSilhouette(topology, cluster, facing, firstEdge + done, std::min(kChunk, count - done), found);
        written += writeSides(std::span(found, edges), out + written);
    }
    return written;
}

std::uint32_t writeCaps(const Topology& topology, bool closed, std::span<const std::uint8_t> facing, bool mirrored,
                        std::uint32_t firstPlace, std::uint32_t count, std::uint32_t* out)
{
    std::uint32_t* end = out;
    for (std::uint32_t place = firstPlace; place < firstPlace + count; ++place) {
        const std::uint32_t face = topology.faceAt(place);
        if (!blocksLight(closed, facing[face], mirrored)) continue;
        const std::uint32_t* corner = &topology.faceVerts[3 * face];
        const std::uint32_t a = 2 * corner[0];
        const std::uint32_t b = 2 * corner[facing[face] ? 1 : 2], c = 2 * corner[facing[face] ? 2 : 1];
        const std::uint32_t corners[6] = {a, b, c, a + 1, c + 1, b + 1};
        end = std::copy_n(corners, 6, end);
    }
    return static_cast<std::uint32_t>(end - out);
}

} // namespace gnomon
