// Which watertight shells of a mesh are inside out.
#include <doctest/doctest.h>

#include <algorithm>

#include <glm/geometric.hpp>

#include "runtime/scene/topology.hpp"

using namespace gnomon;

namespace {

enum class Wound : std::uint8_t { outwards, inwards };

/// Boxes in one mesh.
struct Boxes {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;

    Boxes& add(const glm::vec3& center, const glm::vec3& size, Wound wound, std::uint32_t faces = 12)
    {
        constexpr std::uint32_t kFaces[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (unsigned i = 0; i < 8; ++i)
            positions.push_back(center + 0.5f * size * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
        for (std::uint32_t face = 0; face < faces; ++face)
            for (std::uint32_t corner = 0; corner < 3; ++corner)
                indices.push_back(first + kFaces[3 * face + (wound == Wound::outwards ? corner : 2 - corner)]);
        return *this;
    }
    Topology topology() const { return buildTopology(positions, indices); }
};

constexpr glm::vec3 kOrigin(0.0f), kAside(5.0f, 0.0f, 0.0f);

glm::vec3 cube(float size)
{
    return glm::vec3(size);
}

std::size_t insideOut(const Topology& topology)
{
    return static_cast<std::size_t>(std::ranges::count(topology.clusters, true, &Topology::Cluster::insideOut));
}

void checkSolid(const Boxes& boxes)
{
    const Topology topology = boxes.topology();
    CHECK(topology.closed);
    CHECK(insideOut(topology) == 0);
    CHECK_FALSE(topology.whole.insideOut);
}

void checkInsideOut(const Boxes& boxes)
{
    const Topology topology = boxes.topology();
    CHECK_FALSE(topology.closed);
    CHECK(topology.whole.watertight);
    CHECK(topology.whole.insideOut);
    CHECK(insideOut(topology) >= 1);
}

} // namespace

TEST_CASE("a box wound inwards is inside out, at any size, and one with a face missing is only open")
{
    for (const float size : {1e-4f, 1.0f, 1e4f}) {
        CAPTURE(size);
        checkSolid(Boxes().add(kAside, cube(size), Wound::outwards));
        checkInsideOut(Boxes().add(kAside, cube(size), Wound::inwards));
    }
    checkInsideOut(Boxes().add(kOrigin, {1.0f, 1e-4f, 1.0f}, Wound::inwards)); // as thin as a card
    const Topology open = Boxes().add(kOrigin, cube(1.0f), Wound::inwards, 11).topology();
    CHECK_FALSE(open.closed);
    CHECK_FALSE(open.whole.insideOut);
}

TEST_CASE("a sheet with two sides in one place has no inside")
{
    Boxes sheet = Boxes().add(kOrigin, {1.0f, 0.0f, 1.0f}, Wound::inwards);
    CHECK_FALSE(sheet.topology().whole.insideOut);
}

TEST_CASE("a cavity is no fault of a solid, nor is a solid in the cavity; a hollow wound the other way is one")
{
    checkSolid(Boxes().add(kOrigin, cube(3.0f), Wound::outwards).add(kOrigin, cube(2.0f), Wound::inwards));
    checkSolid(Boxes()
                   .add(kOrigin, cube(1.0f), Wound::outwards)
                   .add(kOrigin, cube(2.0f), Wound::inwards)
                   .add(kOrigin, cube(3.0f), Wound::outwards));
    checkInsideOut(Boxes().add(kOrigin, cube(3.0f), Wound::inwards).add(kOrigin, cube(2.0f), Wound::outwards));
    checkInsideOut(Boxes() // the solid in the middle is the wrong way round
                       .add(kOrigin, cube(1.0f), Wound::inwards)
                       .add(kOrigin, cube(2.0f), Wound::inwards)
                       .add(kOrigin, cube(3.0f), Wound::outwards));
}

TEST_CASE("beside a solid, above it, or standing on it a box wound inwards is no cavity")
{
    for (const glm::vec3 at : {kAside, glm::vec3(0.0f, 2.0f, 0.0f), glm::vec3(0.0f, 1.5f, 0.0f)}) {
        CAPTURE(at.x);
        CAPTURE(at.y);
        checkInsideOut(Boxes().add(kOrigin, cube(2.0f), Wound::outwards).add(at, cube(1.0f), Wound::inwards));
        checkInsideOut(Boxes().add(at, cube(1.0f), Wound::inwards).add(kOrigin, cube(2.0f), Wound::outwards));
    }
    // Of two far apart, which have a cluster each, the other one stays closed.
    const Topology apart = Boxes()
                               .add(kOrigin, cube(1.0f), Wound::outwards)
                               .add(glm::vec3(1000.0f, 0.0f, 0.0f), cube(1.0f), Wound::inwards)
                               .topology();
    REQUIRE(apart.clusters.size() == 2);
    CHECK(apart.clusters[0].closed);
    CHECK(apart.clusters[1].insideOut);
    CHECK_FALSE(apart.closed);
}

TEST_CASE("positions that turn a mesh inside out are noticed, and so are those that turn it back")
{
    Boxes boxes = Boxes().add(kOrigin, cube(1.0f), Wound::outwards);
    Topology topology = boxes.topology();
    for (int turn = 0; turn < 4; ++turn) {
        for (glm::vec3& p : boxes.positions)
            p.x = -p.x;
        updatePositions(topology, boxes.positions);
        CHECK(topology.closed == (turn % 2 == 1));
        CHECK(topology.clusters[0].insideOut == (turn % 2 == 0));
    }
}

TEST_CASE("ten thousand boxes wound inwards are judged in time")
{
    Boxes boxes;
    for (int i = 0; i < 10'000; ++i)
        boxes.add(3.0f * glm::vec3(i % 22, i / 22 % 22, i / 484), cube(1.0f), Wound::inwards);
    checkInsideOut(boxes); // the time limit of the test is the bound
    Boxes cheese = Boxes().add(glm::vec3(30.0f), cube(100.0f), Wound::outwards);
    for (int i = 0; i < 10'000; ++i)
        cheese.add(3.0f * glm::vec3(i % 22, i / 22 % 22, i / 484), cube(1.0f), Wound::inwards);
    CHECK(cheese.topology().whole.watertight); // cavities beyond the budget count as inside out, which is as right
}
