// Connectivity of meshes of every kind: what the silhouette methods build on.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <thread>

#include <glm/geometric.hpp>

#include "runtime/scene/topology.hpp"

#if defined(__linux__)
#include <cstdio>
#include <unistd.h>
#endif

using namespace gnomon;

namespace {

struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;

    std::size_t faceCount() const { return indices.size() / 3; }
    Topology topology() const { return buildTopology(positions, indices); }
    void flip(std::size_t face) { std::swap(indices[3 * face], indices[3 * face + 1]); }
    void remove(std::size_t face)
    {
        const auto first = indices.begin() + static_cast<std::ptrdiff_t>(3 * face);
        indices.erase(first, first + 3);
    }
};

Mesh cube()
{
    Mesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f);
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return mesh;
}

/// A band of quads closed to a ring in both directions.
Mesh torus(std::uint32_t around, std::uint32_t across)
{
    Mesh mesh;
    constexpr float turn = 6.2831853f;
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t j = 0; j < across; ++j) {
            const float a = turn * static_cast<float>(i) / static_cast<float>(around);
            const float b = turn * static_cast<float>(j) / static_cast<float>(across);
            const float r = 3.0f + std::cos(b);
            mesh.positions.emplace_back(r * std::cos(a), std::sin(b), r * std::sin(a));
        }
    }
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t j = 0; j < across; ++j) {
            const auto at = [&](std::uint32_t di, std::uint32_t dj) {
                return (i + di) % around * across + (j + dj) % across;
            };
            for (const std::uint32_t v : {at(0, 0), at(0, 1), at(1, 1), at(0, 0), at(1, 1), at(1, 0)})
                mesh.indices.push_back(v);
        }
    }
    return mesh;
}

/// Every face has three vertices of its own.
Mesh unshared(const Mesh& mesh)
{
    Mesh result;
    for (const std::uint32_t index : mesh.indices) {
        result.indices.push_back(static_cast<std::uint32_t>(result.positions.size()));
        result.positions.push_back(mesh.positions[index]);
    }
    return result;
}

/// What the topology says must follow from the index list alone: every corner pair of every face that encloses
/// anything is one use of one edge, with the sign of its direction.
void checkUses(const Topology& topology)
{
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    std::map<Pair, std::multimap<std::uint32_t, float>> expected;
    for (std::uint32_t face = 0; face < topology.faceVerts.size() / 3; ++face) {
        const std::uint32_t* v = &topology.faceVerts[3 * face];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = v[i], b = v[(i + 1) % 3];
            expected[{std::min(a, b), std::max(a, b)}].emplace(face, a < b ? 1.0f : -1.0f);
        }
    }
    std::map<Pair, std::multimap<std::uint32_t, float>> found;
    std::uint32_t next = 0;
    for (const Topology::Edge& edge : topology.edges) {
        REQUIRE(edge.firstUse == next);
        next += edge.useCount;
        const float forward = edge.v0 < edge.v1 ? 1.0f : -1.0f;
        for (std::uint32_t i = 0; i < edge.useCount; ++i)
            found[{std::min(edge.v0, edge.v1), std::max(edge.v0, edge.v1)}].emplace(
                topology.uses[edge.firstUse + i].face, topology.uses[edge.firstUse + i].sign * forward);
    }
    REQUIRE(next == topology.uses.size());
    REQUIRE(found == expected);
}

/// Signed multiplicities towards a light: at every vertex as many silhouettes arrive as leave, whatever the mesh.
void checkLoops(const Topology& topology, std::size_t vertexCount, glm::vec3 light)
{
    std::vector<float> balance(vertexCount, 0.0f);
    for (const Topology::Edge& edge : topology.edges) {
        float multiplicity = 0.0f;
        for (std::uint32_t i = 0; i < edge.useCount; ++i) {
            const Topology::EdgeUse& use = topology.uses[edge.firstUse + i];
            const glm::vec4 plane = topology.facePlanes[use.face];
            const bool facing = glm::dot(glm::vec3(plane), light) + plane.w > 0.0f;
            multiplicity += facing ? use.sign : -use.sign;
        }
        balance[edge.v0] -= multiplicity;
        balance[edge.v1] += multiplicity;
    }
    for (const float value : balance)
        REQUIRE(value == 0.0f);
}

} // namespace

TEST_CASE("a cube is closed, orientable and manifold, with 18 edges of two uses each")
{
    const Topology topology = cube().topology();
    CHECK(topology.closed);
    CHECK(topology.orientable);
    CHECK(topology.manifold);
    CHECK(topology.looseFaces == 0);
    CHECK(topology.edges.size() == 18); // 12 of the cube and a diagonal on each side
    for (const Topology::Edge& edge : topology.edges)
        CHECK(edge.useCount == 2);
    checkUses(topology);
}

TEST_CASE("a torus obeys Euler's formula")
{
    const Mesh mesh = torus(24, 12);
    const Topology topology = mesh.topology();
    CHECK(mesh.positions.size() + mesh.faceCount() == topology.edges.size()); // V - E + F = 0
    CHECK(topology.closed);
    CHECK(topology.manifold);
    checkUses(topology);
}

TEST_CASE("corners with equal bits are one vertex, and minus zero equals zero")
{
    const Mesh mesh = torus(16, 8);
    const Topology shared = mesh.topology();
    Mesh soup = unshared(mesh);
    for (std::size_t i = 0; i < soup.positions.size(); i += 2) {
        for (int axis = 0; axis < 3; ++axis) {
            if (soup.positions[i][axis] == 0.0f) soup.positions[i][axis] = -soup.positions[i][axis];
        }
    }
    const Topology welded = soup.topology();
    CHECK(welded.edges.size() == shared.edges.size());
    CHECK(welded.closed);
    CHECK(welded.manifold);
    for (std::size_t i = 0; i < welded.faceVerts.size(); ++i) {
        CHECK(welded.faceVerts[i] <= i); // the first of the welded corners stands for all
        CHECK(soup.positions[welded.faceVerts[i]] == soup.positions[i]);
    }
    checkUses(welded);

    Mesh nearly = unshared(cube());
    nearly.positions[0].x = std::nextafter(nearly.positions[0].x, 0.0f);
    CHECK_FALSE(nearly.topology().closed);
}

TEST_CASE("a hole opens a mesh but leaves it orientable and manifold")
{
    Mesh mesh = cube();
    mesh.remove(5);
    const Topology topology = mesh.topology();
    CHECK_FALSE(topology.closed);
    CHECK(topology.orientable);
    CHECK(topology.manifold);
    CHECK(std::count_if(topology.edges.begin(), topology.edges.end(),
                        [](const Topology::Edge& edge) { return edge.useCount == 1; }) == 3);
    checkUses(topology);
}

TEST_CASE("a flipped face is kept as a loose face and the mesh is neither closed nor orientable")
{
    Mesh mesh = cube();
    mesh.flip(11);
    const Topology topology = mesh.topology();
    CHECK_FALSE(topology.closed);
    CHECK_FALSE(topology.orientable);
    CHECK_FALSE(topology.manifold);
    CHECK(topology.looseFaces == 1);
    CHECK(topology.edges.size() == 18);
    checkUses(topology);
}

TEST_CASE("two cubes that share an edge are closed although that edge has four faces")
{
    Mesh mesh = cube();
    for (const glm::vec3& corner : cube().positions)
        mesh.positions.push_back(corner + glm::vec3(2, 2, 0));
    for (const std::uint32_t index : cube().indices)
        mesh.indices.push_back(index + 8);
    const Topology topology = mesh.topology();
    CHECK(topology.closed);
    CHECK_FALSE(topology.manifold);
    CHECK_FALSE(topology.orientable); // along the shared edge faces run the same way twice
    CHECK(topology.crowded);
    CHECK(topology.edges.size() == 36); // the shared one is there once for each cube
    checkUses(topology);
}

TEST_CASE("two cubes that share a corner are closed and not manifold")
{
    Mesh mesh = cube();
    for (const glm::vec3& corner : cube().positions)
        mesh.positions.push_back(corner + glm::vec3(2, 2, 2));
    for (const std::uint32_t index : cube().indices)
        mesh.indices.push_back(index + 8);
    const Topology topology = mesh.topology();
    CHECK(topology.closed);
    CHECK_FALSE(topology.manifold);
    CHECK(topology.edges.size() == 36);
    checkUses(topology);
}

TEST_CASE("silhouettes close at every vertex, for holes, flipped faces and soups alike")
{
    std::mt19937 random(1);
    for (int warmup = 0; warmup < 20; ++warmup) {
        Mesh mesh = torus(12, 8);
        for (std::size_t face = mesh.faceCount(); face-- > 0;) {
            const auto dice = random() % 10;
            if (dice == 0) mesh.remove(face);
            if (dice == 1) mesh.flip(face);
            if (dice == 2)
                mesh.indices.insert(mesh.indices.end(), {mesh.indices[3 * face], mesh.indices[3 * face + 1],
                                                         static_cast<std::uint32_t>(random() % mesh.positions.size())});
        }
        const Topology topology = mesh.topology();
        CHECK(topology.looseFaces > 0);
        checkUses(topology);
        checkLoops(topology, mesh.positions.size(), {10.0f, 20.0f, 5.0f});
        checkLoops(topology, mesh.positions.size(), {0.0f, 0.0f, 0.0f});
    }
}

TEST_CASE("a fan with more faces than are walked round keeps its edges")
{
    Mesh mesh;
    constexpr std::uint32_t count = 5000;
    mesh.positions.emplace_back(0.0f, 1.0f, 0.0f);
    for (std::uint32_t i = 0; i < count; ++i) {
        const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(count);
        mesh.positions.emplace_back(std::cos(angle), 0.0f, std::sin(angle));
    }
    for (std::uint32_t i = 0; i < count; ++i)
        mesh.indices.insert(mesh.indices.end(), {0, 1 + (i + 1) % count, 1 + i});
    const Topology topology = mesh.topology();
    CHECK(topology.looseFaces == count);
    CHECK(topology.edges.size() == 2 * count);
    checkUses(topology);
}

TEST_CASE("faces that collapse when corners are welded use no edge")
{
    Mesh mesh = cube();
    mesh.positions.push_back(mesh.positions[0]);
    mesh.indices.insert(mesh.indices.end(), {0, 8, 1});
    const Topology topology = mesh.topology();
    CHECK(topology.facePlanes.size() == 13);
    CHECK(topology.closed);
    CHECK(topology.edges.size() == 18);
    checkUses(topology);
}

TEST_CASE("the mean number of sides, and the mean area, are what random directions of light find")
{
    Mesh holed = torus(24, 12);
    holed.remove(7);
    Mesh flipped = torus(24, 12);
    flipped.flip(100);
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    for (const Mesh& mesh : {cube(), torus(24, 12), holed, flipped}) {
        const Topology topology = mesh.topology();
        constexpr int kDirections = 20000;
        double found = 0.0, length = 0.0, area = 0.0;
        for (int i = 0; i < kDirections; ++i) {
            const glm::vec4 light(normal(random), normal(random), normal(random), 0.0f);
            for (std::size_t face = 0; face < topology.facePlanes.size(); ++face) {
                const float along = glm::dot(topology.facePlanes[face], light) / (2.0f * glm::length(light));
                area += double{topology.closed ? std::max(along, 0.0f) : std::abs(along)};
            }
            for (const Topology::Edge& edge : topology.edges) {
                double sum = 0.0; // signed multiplicity
                for (std::uint32_t use = edge.firstUse; use < edge.firstUse + edge.useCount; ++use) {
                    const Topology::EdgeUse& one = topology.uses[use];
                    const bool facing = glm::dot(topology.facePlanes[one.face], light) > 0.0f;
                    sum += facing ? one.sign : -one.sign;
                }
                const double sides = std::abs(sum) / (topology.closed ? 2.0 : 1.0);
                found += sides;
                length += sides * double(glm::distance(mesh.positions[edge.v0], mesh.positions[edge.v1]));
            }
        }
        CHECK(double(topology.whole.meanSides) == doctest::Approx(found / kDirections).epsilon(0.01));
        CHECK(double(topology.whole.meanSideLength) == doctest::Approx(length / kDirections).epsilon(0.01));
        CHECK(double(topology.whole.meanArea) == doctest::Approx(area / kDirections).epsilon(0.01));
    }
    CHECK(cube().topology().whole.meanSides == doctest::Approx(6.0)); // twelve edges at right angles, half of them seen
    CHECK(cube().topology().whole.meanSideLength == doctest::Approx(12.0)); // two metres each
    CHECK(cube().topology().whole.meanArea == doctest::Approx(6.0));        // a quarter of its surface
}

TEST_CASE("nothing is a topology too")
{
    const Topology topology = buildTopology({}, {});
    CHECK(topology.edges.empty());
    CHECK_FALSE(topology.closed);
}

TEST_CASE("face planes hold their corners, look outwards and follow new positions")
{
    Mesh mesh = torus(16, 8);
    Topology topology = mesh.topology();
    const auto check = [&] {
        for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
            const glm::vec4 plane = topology.facePlanes[face];
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 corner = mesh.positions[mesh.indices[3 * face + static_cast<std::size_t>(i)]];
                CHECK(std::abs(glm::dot(glm::vec3(plane), corner) + plane.w) < 1e-5f * glm::length(glm::vec3(plane)));
            }
        }
    };
    check();
    for (glm::vec3& position : mesh.positions)
        position = glm::vec3(position.y, 2.0f * position.x, position.z + 1.0f);
    updatePositions(topology, mesh.positions);
    check();
    const Topology box = cube().topology();
    for (std::size_t face = 0; face < box.facePlanes.size(); ++face)
        CHECK(box.facePlanes[face].w == doctest::Approx(-4.0f)); // area 2 x 2, distance 1
}

#if defined(__linux__)
TEST_CASE("several threads build broken meshes and nothing is printed")
{
    std::FILE* capture = std::tmpfile();
    REQUIRE(capture);
    std::fflush(stdout);
    std::fflush(stderr);
    const int out = dup(STDOUT_FILENO), err = dup(STDERR_FILENO);
    dup2(fileno(capture), STDOUT_FILENO);
    dup2(fileno(capture), STDERR_FILENO);
    std::array<std::uint32_t, 4> loose{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < loose.size(); ++t) {
        threads.emplace_back([&loose, t] {
            std::mt19937 random(static_cast<unsigned>(t));
            std::vector<glm::vec3> positions(200);
            for (std::size_t i = 0; i < positions.size(); ++i)
                positions[i] = glm::vec3(static_cast<float>(i), static_cast<float>(i * i % 17), 0.0f);
            std::vector<std::uint32_t> indices(3 * 5000); // any three corners: every refusal there is
            for (std::uint32_t& index : indices)
                index = static_cast<std::uint32_t>(random() % positions.size());
            loose[t] = buildTopology(positions, indices).looseFaces;
        });
    }
    for (std::thread& thread : threads)
        thread.join();
    std::fflush(stdout);
    std::fflush(stderr);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    close(out);
    close(err);
    CHECK(std::fseek(capture, 0, SEEK_END) == 0);
    CHECK(std::ftell(capture) == 0);
    std::fclose(capture);
    for (const std::uint32_t count : loose)
        CHECK(count > 1000);
}
#endif
