// Where the sheets of a mesh end, seen from a light.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "algorithms/hybrid/sheet_edges.hpp"

using namespace gnomon;

namespace {

struct Shape {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
};

constexpr glm::vec4 kAbove(0.0f, 1.0f, 0.0f, 0.0f); ///< A light without a place, in the sky.

/// A square of n x n quads at height 0, wound to look up.
Shape sheet(int n)
{
    Shape shape;
    for (int z = 0; z <= n; ++z)
        for (int x = 0; x <= n; ++x)
            shape.positions.emplace_back(float(x), 0.0f, float(z));
    for (int z = 0; z < n; ++z) {
        for (int x = 0; x < n; ++x) {
            const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((z + j) * (n + 1) + x + i); };
            for (const std::uint32_t index : {at(0, 0), at(0, 1), at(1, 0), at(1, 0), at(0, 1), at(1, 1)})
                shape.indices.push_back(index);
        }
    }
    return shape;
}

/// Corners not shared: three positions a triangle.
Shape unwelded(const Shape& shape)
{
    Shape result;
    for (const std::uint32_t index : shape.indices) {
        result.indices.push_back(static_cast<std::uint32_t>(result.positions.size()));
        result.positions.push_back(shape.positions[index]);
    }
    return result;
}

Shape box()
{
    Shape shape;
    for (int i = 0; i < 8; ++i)
        shape.positions.emplace_back(float(i & 1), float(i >> 1 & 1), float(i >> 2));
    const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : quads)
        for (const int corner : {0, 1, 2, 0, 2, 3})
            shape.indices.push_back(static_cast<std::uint32_t>(q[corner]));
    return shape;
}

std::vector<Turned> turnedOf(const Shape& shape, const Topology& topology, const glm::vec4& light,
                             bool mirrored = false)
{
    std::vector<Turned> turned(shape.indices.size() / 3);
    findTurned(topology, shape.positions, light, mirrored, turned);
    return turned;
}

/// A border as its two ends, in whatever order.
using Border = std::set<std::array<float, 3>>;

std::vector<Border> bordersOf(const Shape& shape, const glm::vec4& light, bool mirrored = false)
{
    const Topology topology = buildTopology(shape.positions, shape.indices);
    std::vector<std::uint32_t> words(sheetListWords(topology.edges.size()));
    writeSheetEdges(topology, turnedOf(shape, topology, light, mirrored), topology.closed, words);
    CHECK(words[1] == 1);
    CHECK(words[2] == kSheetListHeader);
    std::vector<Border> borders;
    for (std::uint32_t i = kSheetListHeader; i < kSheetListHeader + words[0]; i += 3) {
        CHECK(words[i + 1] == words[i + 2]);
        const glm::vec3 a = shape.positions[words[i]], b = shape.positions[words[i + 1]];
        borders.push_back({{a.x, a.y, a.z}, {b.x, b.y, b.z}});
    }
    std::sort(borders.begin(), borders.end());
    return borders;
}

} // namespace

TEST_CASE("an open sheet ends at its rim, from both sides, and nowhere inside: no vertex has a hole")
{
    for (const float up : {1.0f, -1.0f}) {
        const std::vector<Border> borders = bordersOf(sheet(4), up * kAbove);
        CHECK(borders.size() == 16);
        for (const Border& border : borders)
            for (const auto& end : border)
                CHECK((end[0] == 0.0f || end[0] == 4.0f || end[2] == 0.0f || end[2] == 4.0f));
    }
}

TEST_CASE("corners that are not shared give the same borders")
{
    CHECK(bordersOf(unwelded(sheet(3)), kAbove) == bordersOf(sheet(3), kAbove));
    CHECK(bordersOf(unwelded(box()), {0.3f, 1.0f, 0.2f, 0.0f}) == bordersOf(box(), {0.3f, 1.0f, 0.2f, 0.0f}));
}

TEST_CASE("a closed box ends where what is turned away meets what is not, and mirrored at the same edges")
{
    const glm::vec4 aslant(0.3f, 1.0f, 0.2f, 0.0f);
    CHECK(bordersOf(box(), aslant).size() == 6); // the hexagon around a corner
    CHECK(bordersOf(box(), aslant, true) == bordersOf(box(), aslant));
    // From straight above the sides are edge-on: what lies between a side and the bottom ends, and so do the sides' own
    // edges.
    CHECK(bordersOf(box(), kAbove).size() >= 4);
}

TEST_CASE("a face that is flipped, and a third one at an edge, end the sheet there")
{
    Shape flipped = sheet(2);
    std::swap(flipped.indices[0], flipped.indices[1]);
    CHECK(bordersOf(flipped, kAbove).size() >= bordersOf(sheet(2), kAbove).size() + 1);
    Shape fin = sheet(2);
    fin.positions.emplace_back(1.0f, 0.6f, 0.4f);
    for (const std::uint32_t index : {4u, 1u, 9u}) // on the inner edge from (1, 0) to (1, 1)
        fin.indices.push_back(index);
    const auto borders = bordersOf(fin, kAbove);
    const Border inner = {{1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 1.0f}};
    CHECK(std::find(borders.begin(), borders.end(), inner) != borders.end());
}

TEST_CASE("an edge is kept where the neighbour is turned away, and lies opposite to its bit's corner")
{
    const Shape shape = sheet(1); // two triangles that share the edge 1-2
    const Topology topology = buildTopology(shape.positions, shape.indices);
    std::vector<std::uint32_t> words(keptEdgeWords(2));
    setKeptEdges(topology, turnedOf(shape, topology, -kAbove), words);
    CHECK((words[0] & 7u) == 1u);      // 0, 2, 1: opposite to corner 0
    CHECK((words[0] >> 4 & 7u) == 4u); // 1, 2, 3: opposite to corner 2
    setKeptEdges(topology, turnedOf(shape, topology, kAbove), words);
    CHECK(words[0] == 0u);
}

TEST_CASE("a face is edge-on to within the rounding of the light, and turned beyond it")
{
    const Shape shape = sheet(1);
    const Topology topology = buildTopology(shape.positions, shape.indices);
    CHECK(turnedOf(shape, topology, {1.0f, 1e-7f, 0.0f, 0.0f})[0] == Turned::edgeOn);
    CHECK(turnedOf(shape, topology, {1.0f, 1e-5f, 0.0f, 0.0f})[0] == Turned::towards);
    CHECK(turnedOf(shape, topology, {1.0f, -1e-5f, 0.0f, 0.0f})[0] == Turned::away);
    CHECK(turnedOf(shape, topology, {1.0f, -1e-5f, 0.0f, 0.0f}, true)[0] == Turned::towards);
}
