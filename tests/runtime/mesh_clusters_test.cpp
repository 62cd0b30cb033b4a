// Which faces of a mesh hang together, and what of a mesh has a volume of its own.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>

#include "runtime/scene/mesh_clusters.hpp"
#include "runtime/scene/topology.hpp"

using namespace gnomon;

namespace {

struct Soup {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;

    void box(glm::vec3 lower, glm::vec3 upper)
    {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (unsigned i = 0; i < 8; ++i)
            positions.emplace_back((i & 1 ? upper : lower).x, (i & 2 ? upper : lower).y, (i & 4 ? upper : lower).z);
        for (const std::uint32_t v : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
            indices.push_back(first + v);
    }
    /// One side of the floor y = 0; `both`: a second one, that looks down.
    void floor(float size, bool both)
    {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (unsigned i = 0; i < 4; ++i)
            positions.emplace_back(i & 1 ? size : -size, 0.0f, i & 2 ? size : -size);
        for (const std::uint32_t v : {0, 2, 1, 1, 2, 3})
            indices.push_back(first + v);
        if (!both) return;
        for (const std::uint32_t v : {0, 1, 2, 1, 3, 2})
            indices.push_back(first + v);
    }
    Topology topology() const { return buildTopology(positions, indices); }
};

/// What holds of the clusters of any mesh.
void checkClusters(const Soup& soup, const Topology& topology)
{
    const std::size_t faces = topology.faceVerts.size() / 3;
    REQUIRE(!topology.clusters.empty());
    REQUIRE(topology.clusters.size() <= kMostClusters);
    REQUIRE(topology.clusterOfFace.size() == (topology.clusters.size() > 1 ? faces : 0));
    std::vector<bool> seen(faces);
    std::uint32_t nextFace = 0, nextEdge = 0;
    for (const Topology::Cluster& cluster : topology.clusters) {
        REQUIRE(cluster.firstFace == nextFace);
        REQUIRE(cluster.firstEdge == nextEdge);
        nextFace += cluster.faceCount;
        nextEdge += cluster.edgeCount;
        REQUIRE(cluster.faceCount > 0);
        Aabb bounds{soup.positions[topology.faceVerts[3 * topology.faceAt(cluster.firstFace)]], {}};
        bounds.upper = bounds.lower;
        for (std::uint32_t place = cluster.firstFace; place < nextFace; ++place) {
            const std::uint32_t face = topology.faceAt(place);
            REQUIRE(&topology.clusterOf(face) == &cluster);
            REQUIRE(!seen[face]);
            seen[face] = true;
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 corner = soup.positions[topology.faceVerts[3 * face + i]];
                bounds = unionOf(bounds, {corner, corner});
            }
        }
        CHECK(cluster.bounds.lower == bounds.lower);
        CHECK(cluster.bounds.upper == bounds.upper);
        bool closed = true;
        for (const Topology::Edge& edge : edgesOf(topology, cluster)) {
            float sum = 0.0f;
            for (std::uint32_t use = edge.firstUse; use < edge.firstUse + edge.useCount; ++use) {
                REQUIRE(&topology.clusterOf(topology.uses[use].face) == &cluster);
                sum += topology.uses[use].sign;
            }
            closed = closed && sum == 0.0f;
        }
        CHECK(cluster.watertight == closed);
        CHECK(cluster.closed == (closed && !cluster.insideOut));
    }
    CHECK(nextFace == faces);
    CHECK(nextEdge == topology.edges.size());
    CHECK(std::all_of(seen.begin(), seen.end(), [](bool each) { return each; }));
}

} // namespace

TEST_CASE("what hangs together is one cluster, in the order of the mesh")
{
    Soup soup;
    soup.box({0, 0, 0}, {1, 2, 3});
    const Topology topology = soup.topology();
    CHECK(topology.clusters.size() == 1);
    CHECK(topology.facesInOrder.empty());
    checkClusters(soup, topology);
}

TEST_CASE("a box far from a floor is a cluster of its own, closed though the mesh is not")
{
    Soup soup;
    soup.floor(10.0f, false);
    soup.box({3, 1, 3}, {4, 2, 4});
    const Topology topology = soup.topology();
    checkClusters(soup, topology);
    REQUIRE(topology.clusters.size() == 2);
    CHECK_FALSE(topology.closed);
    CHECK_FALSE(topology.clusters[0].closed); // in the order of the mesh: the floor first
    CHECK(topology.clusters[1].closed);
    CHECK(topology.clusters[1].bounds.lower == glm::vec3(3, 1, 3));
}

TEST_CASE("walls that touch at edges and corners stay apart")
{
    Soup soup; // a room: six boxes, each with corners of its neighbours
    soup.box({-5, -1, -5}, {5, 0, 5});
    soup.box({-5, 8, -5}, {5, 9, 5});
    soup.box({-6, 0, -5}, {-5, 8, 5});
    soup.box({5, 0, -5}, {6, 8, 5});
    soup.box({-5, 0, -6}, {5, 8, -5});
    soup.box({-5, 0, 5}, {5, 8, 6});
    const Topology topology = soup.topology();
    checkClusters(soup, topology);
    CHECK(topology.crowded);
    CHECK_FALSE(topology.manifold);
    CHECK(topology.closed);
    CHECK(topology.clusters.size() == 6);
    CHECK(topology.edges.size() == 6 * 18);
}

TEST_CASE("crates on top of each other are one volume each, whatever the order of their faces")
{
    std::mt19937 random(3);
    for (int warmup = 0; warmup < 50; ++warmup) {
        Soup soup;
        for (int x = 0; x < 3; ++x)
            for (int y = 0; y < 3; ++y)
                soup.box(glm::vec3(x, y, 0), glm::vec3(x + 1, y + 1, 1));
        std::vector<std::array<std::uint32_t, 3>> faces(soup.indices.size() / 3);
        std::copy(soup.indices.begin(), soup.indices.end(), faces[0].data());
        std::shuffle(faces.begin(), faces.end(), random);
        std::copy_n(faces[0].data(), soup.indices.size(), soup.indices.begin());
        const glm::vec3 skew(0.3f, -0.2f, 0.1f);
        for (glm::vec3& p : soup.positions)
            p += skew * p.x + glm::vec3(0.0f, 0.0f, 0.4f * p.y);
        const Topology topology = soup.topology();
        checkClusters(soup, topology);
        CHECK(topology.closed);
        CHECK(topology.clusters.size() == 9);
        for (const Topology::Cluster& cluster : topology.clusters)
            CHECK(cluster.closed);
    }
}

TEST_CASE("a sheet with a back is one cluster, and closed")
{
    Soup soup;
    soup.floor(2.0f, true);
    const Topology topology = soup.topology();
    checkClusters(soup, topology);
    CHECK(topology.crowded); // its diagonal
    CHECK(topology.closed);
    CHECK(topology.clusters.size() == 1);
}

TEST_CASE("a thousand boxes are at most as many clusters as there may be, each of boxes side by side")
{
    Soup soup;
    for (int x = 0; x < 10; ++x)
        for (int y = 0; y < 10; ++y)
            for (int z = 0; z < 10; ++z)
                soup.box(glm::vec3(3 * x, 3 * y, 3 * z), glm::vec3(3 * x + 1, 3 * y + 1, 3 * z + 1));
    const Topology topology = soup.topology();
    checkClusters(soup, topology);
    CHECK(topology.clusters.size() == kMostClusters);
    CHECK(topology.closed);
    for (const Topology::Cluster& cluster : topology.clusters) {
        const glm::vec3 size = cluster.bounds.upper - cluster.bounds.lower;
        CHECK(std::max({size.x, size.y, size.z}) <= 7.0f); // two or three boxes
    }
}

TEST_CASE("boxes that lie in each other are cut into no more draws than that saves")
{
    Soup soup;
    for (int i = 0; i < 20; ++i)
        soup.box(glm::vec3(-1.0f - 0.01f * static_cast<float>(i)), glm::vec3(1.0f + 0.01f * static_cast<float>(i)));
    const Topology topology = soup.topology();
    checkClusters(soup, topology);
    CHECK(topology.clusters.size() == 1);
}

TEST_CASE("clusters of any triangles hold each once, and move with them")
{
    std::mt19937 random(5);
    std::size_t several = 0;
    for (int warmup = 0; warmup < 200; ++warmup) {
        Soup soup;
        const auto count = static_cast<unsigned>(3 + random() % 40);
        for (unsigned i = 0; i < count; ++i)
            soup.positions.emplace_back(static_cast<float>(random() % 9), static_cast<float>(random() % 9),
                                        static_cast<float>(random() % 9));
        const auto faces = static_cast<unsigned>(1 + random() % 60);
        for (unsigned i = 0; i < 3 * faces; ++i)
            soup.indices.push_back(static_cast<std::uint32_t>(random() % count));
        if (warmup % 2) soup.box({2, 2, 2}, {3, 4, 5});
        Topology topology = soup.topology();
        checkClusters(soup, topology);
        several += topology.clusters.size() > 1;
        for (glm::vec3& position : soup.positions)
            position = glm::vec3(2.0f, -1.0f, 0.5f) * position + glm::vec3(0.0f, 3.0f, 1.0f);
        updatePositions(topology, soup.positions);
        checkClusters(soup, topology);
    }
    CHECK(several > 50);
}

TEST_CASE("an edge with more faces than are asked one by one keeps them together")
{
    Soup soup;
    soup.positions = {{0, 0, 0}, {0, 1, 0}};
    for (std::uint32_t i = 0; i < 200; ++i) {
        soup.positions.emplace_back(static_cast<float>(i), 0.0f, 1.0f);
        soup.indices.insert(soup.indices.end(), {0, 1, 2 + i});
    }
    const Topology topology = soup.topology();
    checkClusters(soup, topology);
    CHECK(topology.clusters.size() == 1);
}
