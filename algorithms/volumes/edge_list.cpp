#include "algorithms/volumes/edge_list.hpp"

#include <algorithm>
#include <bit>

#include "shaders/volumes/all_edges.h"

namespace gnomon {

namespace {

constexpr std::uint64_t kWordsPerCommand = 5; // VkDrawIndexedIndirectCommand

/// Takes the uses of an edge one after another, by direction.
class UseTaker {
public:
    UseTaker(const Topology& topology, const Topology::Edge& edge)
        : uses_(std::span(topology.uses).subspan(edge.firstUse, edge.useCount))
    {
    }

    /// One that runs v0 -> v1 if `forward`, else v1 -> v0; where there is none left, any; null where none is left at
    /// all.
    const Topology::EdgeUse* take(bool forward)
    {
        const Topology::EdgeUse* use = takeExactly(forward);
        return use ? use : takeExactly(!forward);
    }

private:
    const Topology::EdgeUse* takeExactly(bool forward)
    {
        std::size_t& next = next_[forward ? 1 : 0];
        while (next < uses_.size()) {
            const Topology::EdgeUse& use = uses_[next++];
            if ((use.sign > 0.0f) == forward) return &use;
        }
        return nullptr;
    }

    std::span<const Topology::EdgeUse> uses_;
    std::size_t next_[2] = {0, 0};
};

/// Fills indices and slots front to back.
class ListWriter {
public:
    ListWriter(std::span<std::uint32_t> out, const EdgeListSize& size, std::size_t faces)
        : out_(out), nextIndex_(static_cast<std::uint32_t>(size.commandWords())),
          nextSlot_(static_cast<std::uint32_t>(size.firstSlot())),
          firstPlane_(static_cast<std::uint32_t>(size.firstSlot() + size.slots() - faces))
    {
    }

    void side(const Topology::Edge& edge, const Topology::EdgeUse& a, const Topology::EdgeUse& b)
    {
        constexpr std::uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
        for (const std::uint32_t corner : corners)
            out_[nextIndex_++] = 4 * nextSlot_ + corner;
        slot(edge.v0, edge.v1, useWord(a), useWord(b));
    }
    void cap(const std::uint32_t* corner, std::uint32_t face)
    {
        constexpr std::uint32_t corners[6] = {0, 1, 2, 4, 6, 5};
        for (const std::uint32_t each : corners)
            out_[nextIndex_++] = 8 * nextSlot_ + each;
        slot(corner[0], corner[1], corner[2], firstPlane_ + face);
    }
    void plane(const glm::vec4& plane)
    {
        slot(std::bit_cast<std::uint32_t>(plane.x), std::bit_cast<std::uint32_t>(plane.y),
             std::bit_cast<std::uint32_t>(plane.z), std::bit_cast<std::uint32_t>(plane.w));
    }
    /// Planes start at a place of their own.
    void startPlanes() { nextSlot_ = firstPlane_; }

    /// Where the next index goes.
    std::uint32_t written() const { return nextIndex_; }
    /// Draws the indices written from `first` on.
    void command(std::uint32_t number, std::uint32_t first, std::uint32_t instances)
    {
        const std::uint32_t words[kWordsPerCommand] = {nextIndex_ - first, instances, first, 0, 0};
        std::copy_n(words, kWordsPerCommand, &out_[number * kWordsPerCommand]);
    }

private:
    std::uint32_t useWord(const Topology::EdgeUse& use) const
    {
        return 2 * (firstPlane_ + use.face) + (use.sign > 0.0f ? 1 : 0);
    }
    void slot(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t w)
    {
        const std::uint32_t words[4] = {x, y, z, w};
        std::copy_n(words, 4, &out_[std::size_t{4} * nextSlot_++]);
    }

    std::span<std::uint32_t> out_;
    std::uint32_t nextIndex_, nextSlot_, firstPlane_;
};

void writePairs(const Topology& topology, const Topology::Cluster& cluster, ListWriter& writer)
{
    // Faces that run the edge in opposite directions first: of those that look the same way nothing is drawn.
    for (const Topology::Edge& edge : edgesOf(topology, cluster)) {
        UseTaker uses(topology, edge);
        for (std::uint32_t left = edge.useCount; left >= 2; left -= 2) {
            const Topology::EdgeUse* first = uses.take(true);
            writer.side(edge, *first, *uses.take(false));
        }
    }
}

void writeBorders(const Topology& topology, const Topology::Cluster& cluster, ListWriter& writer)
{
    for (const Topology::Edge& edge : edgesOf(topology, cluster)) {
        if (edge.useCount % 2 == 0) continue;
        UseTaker uses(topology, edge);
        const Topology::EdgeUse* last = nullptr;
        for (std::uint32_t i = 0; i < edge.useCount; ++i)
            last = uses.take(i % 2 == 0);
        writer.side(edge, *last, *last);
    }
}

void writeFaces(const Topology& topology, const Topology::Cluster& cluster, ListWriter& writer)
{
    for (std::uint32_t place = cluster.firstFace; place < cluster.firstFace + cluster.faceCount; ++place) {
        const std::uint32_t face = topology.faceAt(place);
        writer.cap(&topology.faceVerts[std::size_t{3} * face], face);
    }
}

/// Both faces of an open mesh count, those of a closed one by half.
std::uint32_t timesDrawn(EdgeCommand command, const Topology::Cluster& cluster)
{
    return command == kPairCommand && !cluster.closed ? 2 : 1;
}

} // namespace

std::uint64_t EdgeListSize::commandWords() const
{
    return (clusters + 1) * kEdgeCommands * kWordsPerCommand;
}

std::uint64_t EdgeListSize::firstSlot() const
{
    return (commandWords() + indices() + 3) / 4;
}

EdgeListSize edgeListSize(const Topology& topology)
{
    // Every edge makes half as many records as it has uses, rounded up.
    const std::uint64_t uses = topology.uses.size(), edges = topology.edges.size();
    return {.records = topology.closed ? uses / 2 : (uses + edges) / 2,
            .faces = topology.facePlanes.size(),
            .clusters = topology.clusters.size()};
}

void writeEdgeList(const Topology& topology, std::span<std::uint32_t> out)
{
    const std::size_t faces = topology.facePlanes.size();
    ListWriter writer(out, edgeListSize(topology), faces);
    using Write = void (*)(const Topology&, const Topology::Cluster&, ListWriter&);
    constexpr Write write[kEdgeCommands] = {writePairs, writeBorders, writeFaces};
    const auto whole = static_cast<std::uint32_t>(topology.clusters.size());
    for (const EdgeCommand command : {kPairCommand, kBorderCommand, kCapCommand}) {
        const std::uint32_t begin = writer.written();
        for (std::uint32_t cluster = 0; cluster < whole; ++cluster) {
            const std::uint32_t first = writer.written();
            write[command](topology, topology.clusters[cluster], writer);
            writer.command(commandOf(cluster, command), first, timesDrawn(command, topology.clusters[cluster]));
        }
        writer.command(commandOf(whole, command), begin, timesDrawn(command, topology.whole));
    }
    writer.startPlanes();
    for (std::size_t face = 0; face < faces; ++face)
        writer.plane(topology.facePlanes[face]);
}

} // namespace gnomon
