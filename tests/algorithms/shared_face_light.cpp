// Lamps in the plane of a caster's face: volumes leave touched faces out, maps draw casters beside them
// (face_light.hpp).
#include <doctest/doctest.h>

#include "algorithms/shared/face_light.hpp"
#include "runtime/scene/light_fit.hpp"
#include "tests/algorithms/volume_cases.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Under lamps that lie in the middle of one of the caster's faces, but for rounding.
template <typename Body>
void forTouchedCases(Body&& body)
{
    for (const Case& c : cases())
        for (const glm::mat3& basis : bases()) {
            const Placed placed(c.mesh, basis, kPlace);
            const std::size_t faces = placed.topology.facePlanes.size();
            for (std::size_t face = 0; face < faces; face += faces / 5) {
                CAPTURE(c.name);
                CAPTURE(glm::determinant(basis));
                CAPTURE(face);
                const std::uint32_t* v = &placed.topology.faceVerts[3 * face];
                body(placed, pointLight((placed.world(v[0]) + placed.world(v[1]) + placed.world(v[2])) / 3.0f), face);
            }
        }
}

} // namespace

TEST_CASE("a face that the light touches stops none of its light")
{
    Random random(13);
    int shadowed = 0, lit = 0;
    forTouchedCases([&](const Placed& placed, const LightView& light, std::size_t touched) {
        const Lists lists(placed, light);
        CHECK(!lists.blocks(placed, static_cast<std::uint32_t>(touched)));
        const Volume volume(placed, glm::dvec3(light.position()));
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 p = random.inBox(kBox.lower, kBox.upper);
            const glm::dvec3 outside = p + 1e7 * glm::dvec3(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
            const int wound = volume.crossings(lists.sides, p, outside) + volume.crossings(lists.caps, p, outside);
            const int expected = facesBetween(placed, p, glm::dvec3(light.position()),
                                              [&](std::uint32_t face) { return lists.blocks(placed, face); });
            CHECK(wound == expected);
            (expected ? shadowed : lit) += 1;
        }
    });
    CHECK(shadowed > 500);
    CHECK(lit > 500);
}

TEST_CASE("a closed caster steps back until the light is before the faces that it touches, an open one loses these")
{
    forTouchedCases([](const Placed& placed, const LightView& light, std::size_t touched) {
        Caster caster = placed.caster;
        caster.closed = placed.topology.closed;
        std::vector<bool> drawn(placed.topology.facePlanes.size());
        glm::dvec3 away(0.0);
        forDrawnParts(light, caster, [&](const DrawnPart& part) {
            away = part.away;
            const std::size_t end = std::min<std::size_t>(drawn.size(), std::size_t{part.firstFace} + part.faceCount);
            for (std::size_t face = part.firstFace; face < end; ++face) {
                CHECK(!drawn[face]);
                drawn[face] = true;
            }
        });
        const double touch = touchingDistance(light, 0.0); // at least
        if (!caster.closed) {
            CHECK(away == glm::dvec3(0.0));
            CHECK(!drawn[touched]);
            for (std::uint32_t face = 0; face < drawn.size(); ++face) // what else is left out lies at the light as well
                CHECK(drawn[face] == !isAtLight(light, caster, face));
            return;
        }
        CHECK(std::count(drawn.begin(), drawn.end(), false) == 0);
        const std::uint32_t* v = &placed.topology.faceVerts[3 * touched];
        const glm::dvec3 a = placed.world(v[0]), b = placed.world(v[1]), c = placed.world(v[2]);
        glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
        if (caster.mirrored) normal = -normal;
        const double before = glm::dot(normal, glm::dvec3(light.position()) - a - away);
        CHECK(before > touch);
        CHECK(glm::length(away) < 20.0 * touch);
        CHECK(awayFromLight(pointLight(kPlace + glm::vec3(0.0f, 9.0f, 0.0f)), caster) == glm::vec3(0.0f));
    });
}

TEST_CASE("what the light touches leaves sides in closed loops, the same on the device")
{
    forTouchedCases([](const Placed& placed, const LightView& light, std::size_t) {
        const Lists lists(placed, light);
        CHECK(loopsAreClosed(lists.sides));
        const DeviceLists device(placed, light);
        CHECK(sums(device.sides) == sums(lists.sides));
        CHECK(counted(device.caps) == counted(lists.caps));
    });
}
