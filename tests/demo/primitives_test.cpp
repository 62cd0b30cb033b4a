#include "demo/scene/primitives.hpp"
#include "scene_analysis.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace gnomon::demo;
using doctest::Approx;

namespace {

struct ClosedCase {
    const char* name;
    Mesh mesh;
    double volume; ///< Of the polyhedron, where a formula is at hand; 0 otherwise.
    int64_t euler; ///< Vertices - edges + faces: 2 for a ball, 0 for a ring.
};

/// Area of a regular polygon over that of its circle times radius squared.
double polygonArea(uint32_t corners, double radius)
{
    return 0.5 * corners * std::sin(2.0 * std::numbers::pi / corners) * radius * radius;
}

double volumeOf(const BuildingShape& s)
{
    // Windows take 0.55 x 0.5 of their bay, the parapet is 0.9 m high.
    const double inside = (s.width - 2.0 * s.recess) * (s.depth - 2.0 * s.recess);
    const double bay = (s.width - 2.0 * s.recess) / s.bays, sideBay = (s.depth - 2.0 * s.recess) / s.sideBays;
    const double windows = 2.0 * s.floors * (s.bays * bay + s.sideBays * sideBay) * 0.55 * 0.5 * s.storey * s.recess;
    return double(s.width) * s.depth * s.storey * s.floors + (s.width * s.depth - inside) * 0.9 - windows;
}

std::vector<ClosedCase> closedCases()
{
    const BuildingShape house{.width = 12.0f, .depth = 9.0f, .floors = 3, .bays = 4, .sideBays = 2};
    const BuildingShape hut{.width = 2.0f, .depth = 2.0f, .storey = 2.5f, .floors = 1, .bays = 1, .sideBays = 1};
    TerrainShape block;
    block.thickness = 1.5f;
    block.columns = 7;
    block.rows = 5;
    ArchShape arch;
    const double halfRing = 0.5 * polygonArea(2 * arch.segments, 1.0) *
                            (arch.outerRadius * arch.outerRadius - arch.innerRadius * arch.innerRadius) * arch.depth;
    return {
        {"box", makeBox({{1.0f, 2.0f, 3.0f}}), 6.0, 2},
        {"sphere", makeSphere({0.5f, 12, 6}), 0.0, 2},
        {"smallest sphere", makeSphere({0.5f, 3, 2}), 0.0, 2},
        {"torus", makeTorus({}), 0.0, 0},
        {"smallest torus", makeTorus({1.0f, 0.35f, 3, 3}), 0.0, 0},
        {"torus knot", makeTorusKnot({}), 0.0, 0},
        {"trefoil of other kind", makeTorusKnot({1.0f, 0.4f, 0.1f, 3, 2, 120, 8}), 0.0, 0},
        {"cylinder", makeCylinder({0.5f, 0.5f, 2.0f, 24, 3}), 2.0 * polygonArea(24, 0.5), 2},
        {"cone stump", makeCylinder({0.5f, 0.2f, 1.0f, 16, 1}), 0.0, 2},
        {"column", makeColumn({}), 0.0, 2},
        {"arch", makeArch(arch), halfRing, 2},
        {"terrain block", makeTerrain(block), 0.0, 2},
        {"building", makeBuilding(house), volumeOf(house), 2},
        {"smallest building", makeBuilding(hut), volumeOf(hut), 2},
    };
}

} // namespace

TEST_CASE("every edge of a closed primitive is used once each way, and outward winding gives a positive volume")
{
    for (const ClosedCase& c : closedCases()) {
        INFO(c.name);
        const EdgeCount edges = countEdges(c.mesh);
        CHECK(edges.border == 0);
        CHECK(edges.unbalanced == 0);
        CHECK(edges.crowded == 0);
        CHECK(signedVolume(c.mesh) > 0.0);
        if (c.volume > 0.0) CHECK(signedVolume(c.mesh) == Approx(c.volume).epsilon(1e-5));
        CHECK(int64_t(c.mesh.positions.size()) - int64_t(edges.edges) + int64_t(c.mesh.triangleCount()) == c.euler);
    }
}

TEST_CASE("no primitive has a zero-area triangle or a vertex that nothing uses")
{
    std::vector<Mesh> meshes = {makePlane({}), makeTerrain({}), makeCloth({}), makeCard({}), makeLeaves({})};
    for (ClosedCase& c : closedCases())
        meshes.push_back(std::move(c.mesh));
    for (const Mesh& mesh : meshes) {
        CHECK(smallestArea(mesh) > 1e-7);
        std::vector<bool> used(mesh.positions.size());
        for (const uint32_t index : mesh.indices)
            used.at(index) = true;
        CHECK(std::find(used.begin(), used.end(), false) == used.end());
    }
}

TEST_CASE("the volume of a fine torus and sphere approaches the closed formula from below")
{
    const double torus = 2.0 * std::numbers::pi * std::numbers::pi * 1.0 * 0.35 * 0.35;
    const double volume = signedVolume(makeTorus({1.0f, 0.35f, 192, 96}));
    CHECK(volume < torus);
    CHECK(volume == Approx(torus).epsilon(2e-3));
    const double ball = signedVolume(makeSphere({0.5f, 128, 64}));
    CHECK(ball < std::numbers::pi / 6.0);
    CHECK(ball == Approx(std::numbers::pi / 6.0).epsilon(2e-3));
}

TEST_CASE("a torus of 48 x 24 segments has 2304 triangles within ring radius plus tube")
{
    const Mesh torus = makeTorus({});
    CHECK(torus.triangleCount() == 2304);
    for (const glm::vec3& p : torus.positions) {
        CHECK(std::hypot(p.x, p.z) <= 1.3500001f);
        CHECK(std::hypot(p.x, p.z) >= 0.6499999f);
        CHECK(std::hypot(std::hypot(p.x, p.z) - 1.0f, p.y) == Approx(0.35).epsilon(1e-5));
    }
}

TEST_CASE("open primitives have a border, face the documented way and keep their size")
{
    const auto normalOf = [](const Mesh& mesh, size_t triangle) {
        const glm::vec3 a = mesh.positions[mesh.indices[triangle * 3]],
                        b = mesh.positions[mesh.indices[triangle * 3 + 1]],
                        c = mesh.positions[mesh.indices[triangle * 3 + 2]];
        return glm::normalize(glm::cross(b - a, c - a));
    };
    const Mesh plane = makePlane({4.0f, 2.0f, 3, 5});
    CHECK(countEdges(plane).border == 16);
    for (size_t t = 0; t < plane.triangleCount(); ++t)
        CHECK(normalOf(plane, t).y == Approx(1.0));
    CHECK(plane.positions.front().x == -2.0f);
    CHECK(plane.positions.back().x == 2.0f);

    const Mesh terrain = makeTerrain({});
    for (size_t t = 0; t < terrain.triangleCount(); ++t)
        CHECK(normalOf(terrain, t).y > 0.0f);

    const Mesh cloth = makeCloth({});
    CHECK(countEdges(cloth).border == 128);
    CHECK(countEdges(cloth).unbalanced == 0);
    for (size_t t = 0; t < cloth.triangleCount(); ++t)
        CHECK(normalOf(cloth, t).z > 0.0f);
    for (const glm::vec3& p : cloth.positions)
        CHECK((p.y <= 0.0f && p.y >= -2.0f));

    CHECK(normalOf(makeCard({}), 0).z == 1.0f);
    CHECK(countEdges(makeCard({})).border == 4);
}

TEST_CASE("leaves lie within their ellipsoid, are turned every way, and closed ones are bodies of their own")
{
    const LeavesShape shape{.size = {6.0f, 4.0f, 2.0f}, .count = 300, .closed = true};
    const Mesh closed = makeLeaves(shape);
    CHECK(closed.triangleCount() == 2400);
    const EdgeCount edges = countEdges(closed);
    CHECK(edges.border == 0);
    CHECK(edges.unbalanced == 0);
    CHECK(edges.crowded == 0);
    // Two pyramids over a rhombus of half the product of its diagonals, together a quarter of the width high.
    CHECK(signedVolume(closed) == Approx(300 * 0.5 * 0.4 * 0.2 * 0.25 * 0.2 / 3.0).epsilon(1e-4));
    glm::vec3 farthest(0.0f);
    for (const glm::vec3& p : closed.positions) {
        CHECK(glm::length(p / (0.5f * shape.size)) <= 1.0f + 0.2f / 1.0f); // half a leaf beyond the shortest half axis
        farthest = glm::max(farthest, glm::abs(p));
    }
    CHECK(farthest.x > 2.5f);

    const Mesh sheets = makeLeaves({});
    CHECK(sheets.triangleCount() == 1000);
    CHECK(countEdges(sheets).border == 2000);
    const Mesh crossed = makeLeaves({.blades = 3});
    CHECK(crossed.triangleCount() == 3000);
    CHECK(countEdges(crossed).border == 6000);
    CHECK(countEdges(crossed).crowded == 500); // the axis of each

    CHECK(makeLeaves({}).positions == sheets.positions);
    CHECK(makeLeaves({.seed = 2}).positions != sheets.positions);
}

TEST_CASE("the triangles of a building are known before it is built")
{
    for (const BuildingShape& shape : {BuildingShape{}, BuildingShape{.floors = 1, .bays = 1, .sideBays = 1},
                                       BuildingShape{.floors = 9, .bays = 7, .sideBays = 2}})
        CHECK(makeBuilding(shape).triangleCount() == triangleCount(shape));
}

TEST_CASE("the terrain is the same everywhere, within its height, and really slopes")
{
    TerrainShape shape;
    const float atCorner = terrainHeight(shape, 0.0f, 0.0f);
    CHECK(atCorner == terrainHeight(shape, -0.0f, 0.0f));
    const Mesh mesh = makeTerrain(shape);
    float low = 1e9f, high = -1e9f, steepest = 1.0f;
    for (const glm::vec3& p : mesh.positions) {
        low = std::min(low, p.y);
        high = std::max(high, p.y);
    }
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::vec3 a = mesh.positions[mesh.indices[t]], b = mesh.positions[mesh.indices[t + 1]],
                        c = mesh.positions[mesh.indices[t + 2]];
        steepest = std::min(steepest, glm::normalize(glm::cross(b - a, c - a)).y);
    }
    CHECK(low >= 0.0f);
    CHECK(high <= shape.height);
    CHECK(high - low > 0.5f * shape.height);
    CHECK(steepest < 0.95f); // 18 degrees
    TerrainShape other = shape;
    other.seed = 2;
    CHECK(terrainHeight(other, 3.0f, 3.0f) != terrainHeight(shape, 3.0f, 3.0f));
}
