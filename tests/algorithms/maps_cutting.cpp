// Casters cut for the paraboloids, and the stamps that say when a map is out of date.
#include <doctest/doctest.h>

#include <array>
#include <map>
#include <tuple>

#include "algorithms/omni/tessellation.hpp"
#include "algorithms/shared/caster_lists.hpp"
#include "maps_fixture.hpp"
#include "runtime/scene/mesh_chunks.hpp"

using namespace gnomon;
using namespace gnomon::test;
using doctest::Approx;

namespace {

LightView lampAt(glm::vec3 position)
{
    return light(GN_LIGHT_TYPE_POINT, position, glm::vec3(0.0f), 1e30f);
}

struct Cube {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    MeshView mesh;
    Caster caster;

    Cube(glm::vec3 lower, glm::vec3 upper, bool mirrored = false)
    {
        for (int i = 0; i < 8; ++i)
            positions.push_back({i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z});
        mesh.positions = positions;
        mesh.indices = indices;
        mesh.bounds = {lower, upper};
        mesh.revision = 3;
        caster.mesh = &mesh;
        caster.bounds = mesh.bounds;
        caster.id = 1;
        caster.revision = 11;
        caster.closed = true;
        if (mirrored) {
            caster.basis[0][0] = -1.0f;
            caster.mirrored = true;
        }
    }
    Cube(const Cube&) = delete;
};

double signedVolume(const FineMesh& fine)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < fine.indices.size(); i += 3) {
        const glm::dvec3 a(fine.vertices[fine.indices[i]]), b(fine.vertices[fine.indices[i + 1]]),
            c(fine.vertices[fine.indices[i + 2]]);
        sum += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return sum;
}

using Point = std::tuple<float, float, float>;
Point pointOf(glm::vec3 v)
{
    return {v.x, v.y, v.z};
}

} // namespace

TEST_CASE("after cutting no edge spans more than the angle, the surface has no gap and encloses the same volume")
{
    const glm::vec3 lamp(0.3f, 2.5f, -0.2f);
    for (const bool mirrored : {false, true}) {
        const Cube cube({-4, -1, -4}, {4, 1, 4}, mirrored);
        const std::array<const Caster*, 1> casters{&cube.caster};
        FineMesh fine;
        const float angle = maxEdgeAngle(1024);
        cutToAngle(casters, lampAt(lamp), angle, fine);
        CHECK(fine.closedIndices == fine.indices.size());
        CHECK(fine.indices.size() > 3 * 1000);

        std::map<std::pair<Point, Point>, int> uses;
        float widest = 0.0f;
        for (std::size_t i = 0; i < fine.indices.size(); ++i) {
            const glm::vec3 a = fine.vertices[fine.indices[i]];
            const glm::vec3 b = fine.vertices[fine.indices[i % 3 == 2 ? i - 2 : i + 1]];
            const glm::dvec3 u = glm::normalize(glm::dvec3(a - lamp)), v = glm::normalize(glm::dvec3(b - lamp));
            widest = std::fmax(widest, static_cast<float>(2.0 * std::asin(0.5 * glm::length(u - v))));
            ++uses[{pointOf(a), pointOf(b)}];
            --uses[{pointOf(b), pointOf(a)}];
        }
        CHECK(widest <= angle * 1.0001f);
        for (const auto& [edge, count] : uses)
            CHECK(count == 0);
        CHECK(signedVolume(fine) == Approx(8.0 * 2.0 * 8.0).epsilon(1e-5)); // positive: the winding is unmirrored
    }
}

TEST_CASE("a light inside an edge does not make the cutting endless")
{
    const Cube cube({-1, -1, -1}, {1, 1, 1});
    const std::array<const Caster*, 1> casters{&cube.caster};
    FineMesh fine;
    cutToAngle(casters, lampAt(glm::vec3(0.37f, 1.0f, 1.0f)), maxEdgeAngle(512), fine);
    CHECK(fine.indices.size() / 3 < 100000);
    CHECK(signedVolume(fine) == Approx(8.0).epsilon(1e-4));
}

TEST_CASE("a face that the light all but lies in leaves no piece that spans more than a right angle")
{
    const Cube cube({-6, 0, -6}, {6, 1, 6});
    const std::array<const Caster*, 1> casters{&cube.caster};
    for (const float off : {0.0f, 1e-6f, -1e-6f, 1e-3f}) {
        CAPTURE(off);
        const glm::vec3 lamp(0.37f, -off, 0.71f);
        FineMesh fine;
        cutToAngle(casters, lampAt(lamp), maxEdgeAngle(512), fine);
        REQUIRE(!fine.indices.empty());
        for (std::size_t i = 0; i < fine.indices.size(); ++i) {
            const glm::vec3 a = fine.vertices[fine.indices[i]];
            const glm::vec3 b = fine.vertices[fine.indices[i % 3 == 2 ? i - 2 : i + 1]];
            REQUIRE(glm::dot(a - lamp, b - lamp) > 0.0f);
        }
    }
}

TEST_CASE("a long thin triangle close to the light is cut into a bounded number of pieces")
{
    const Cube cube({-500, 0, 0}, {500, 0.01f, 0.01f});
    const std::array<const Caster*, 1> casters{&cube.caster};
    FineMesh fine;
    cutToAngle(casters, lampAt(glm::vec3(0.37f, -0.01f, 0.0f)), maxEdgeAngle(1024), fine);
    CHECK(fine.indices.size() > 3 * 100'000);
    CHECK(fine.indices.size() < 3 * 1'100'000);
}

TEST_CASE("a caster called fine enough has no edge that spans more than the angle")
{
    Random random;
    int fineOnes = 0;
    for (int i = 0; i < 500; ++i) {
        Cube cube(glm::vec3(-0.2f), glm::vec3(random.in(0.1f, 1.0f)));
        cube.caster.longestEdge =
            glm::length(edgeSpan(cube.mesh.positions, cube.mesh.indices)); // its basis is the identity
        const glm::vec3 lamp = random.vec(-20.0f, 20.0f);
        const float angle = maxEdgeAngle(256);
        if (!fineEnough(cube.caster, lamp, angle)) continue;
        ++fineOnes;
        const std::array<const Caster*, 1> casters{&cube.caster};
        FineMesh fine;
        cutToAngle(casters, lampAt(lamp), angle, fine);
        CHECK(fine.indices.size() == cube.indices.size());
    }
    CHECK(fineOnes > 100);
}

TEST_CASE("closed casters come first in a cut mesh, open ones after them")
{
    const Cube closed({-1, -1, -1}, {1, 1, 1}), open({2, -1, -1}, {3, 1, 1});
    Caster opened = open.caster;
    opened.closed = false;
    const std::array<const Caster*, 2> casters{&opened, &closed.caster};
    FineMesh fine;
    cutToAngle(casters, lampAt(glm::vec3(0, 40, 0)), maxEdgeAngle(64), fine);
    REQUIRE(fine.closedIndices == closed.indices.size());
    CHECK(fine.vertices[fine.indices[fine.closedIndices]].x >= 2.0f);
    CHECK(fine.vertices[fine.indices[0]].x <= 1.0f);
}

TEST_CASE("a stamp changes with each caster's revision, closedness, and the set, and is never a reserved number")
{
    const Cube a({-1, -1, -1}, {1, 1, 1}), b({2, -1, -1}, {3, 1, 1});
    const std::array<const Caster*, 2> both{&a.caster, &b.caster};
    const std::span<const Caster* const> all(both);
    const auto stampOf = [](std::span<const Caster* const> casters) { return Stamp().add(casters).value(); };
    const std::uint64_t stamp = stampOf(all);
    CHECK(stamp == stampOf(all));
    CHECK(stamp > 15);
    CHECK(stamp != stampOf(all.first(1)));
    Caster moved = a.caster;
    ++moved.revision;
    const std::array<const Caster*, 2> withMoved{&moved, &b.caster};
    CHECK(stamp != stampOf(withMoved));
    Caster opened = a.caster;
    opened.closed = false;
    const std::array<const Caster*, 2> withOpened{&opened, &b.caster};
    CHECK(stamp != stampOf(withOpened));
}
