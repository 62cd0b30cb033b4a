// Silhouettes, caps and extrusion of shadow volumes against brute force in double precision.
#include <doctest/doctest.h>

#include "tests/algorithms/volume_cases.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

glm::dvec3 sourceOf(const LightView& light, glm::dvec3 p)
{
    return light.type == GN_LIGHT_TYPE_DIRECTIONAL ? p - 100.0 * glm::dvec3(light.direction())
                                                   : glm::dvec3(light.position());
}

/// A point of kBox, two times in three behind some triangle.
glm::dvec3 receiver(const Placed& placed, const LightView& light, Random& random)
{
    if (random(0.0f, 3.0f) < 1.0f) return random.inBox(kBox.lower, kBox.upper);
    const auto face =
        static_cast<std::size_t>(random(0.0f, static_cast<float>(placed.mesh.indices.size() / 3) - 0.01f));
    const std::uint32_t* v = &placed.mesh.indices[3 * face];
    const float a = random(0.0f, 0.5f), b = random(0.0f, 0.5f);
    const glm::dvec3 p = placed.world(v[0]) * (1.0f - a - b) + placed.world(v[1]) * a + placed.world(v[2]) * b;
    const glm::dvec3 behind = p + glm::normalize(p - sourceOf(light, p)) * static_cast<double>(random(0.01f, 3.0f));
    return glm::clamp(behind, glm::dvec3(kBox.lower), glm::dvec3(kBox.upper));
}

} // namespace

TEST_CASE("silhouettes form closed loops, whatever the mesh is like")
{
    forAllCases([](const Placed& placed, const LightView& light) {
        const Lists lists(placed, light);
        CHECK(!lists.sides.empty());
        CHECK(loopsAreClosed(lists.sides));
    });
}

TEST_CASE("a volume winds around a point as often as faces stand between the point and the light")
{
    Random random(7);
    int shadowed = 0, lit = 0;
    forAllCases([&](const Placed& placed, const LightView& light) {
        const Lists lists(placed, light);
        const Volume volume(placed, light, kBox);
        REQUIRE(glm::vec3(volume.plane) != glm::vec3(0.0f));
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 p = receiver(placed, light, random);
            const glm::dvec3 source = sourceOf(light, p);
            const glm::dvec3 outside = p + 1000.0 * glm::dvec3(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
            const int wound = volume.crossings(lists.sides, p, outside) + volume.crossings(lists.caps, p, outside);
            const int expected =
                facesBetween(placed, p, source, [&](std::uint32_t face) { return lists.blocks(placed, face); });
            CHECK(wound == expected);
            (expected ? shadowed : lit) += 1;
        }
    });
    CHECK(shadowed > 500);
    CHECK(lit > 500);
}

TEST_CASE("from a lit point, sides alone count right along any segment that meets no face")
{
    Random random(11);
    int shadowed = 0, lit = 0;
    forAllCases([&](const Placed& placed, const LightView& light) {
        const Lists lists(placed, light);
        const Volume volume(placed, light, kBox);
        const auto any = [](std::uint32_t) { return true; };
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 eye(random.inBox(kBox.lower, kBox.upper)), p = receiver(placed, light, random);
            if (facesBetween(placed, eye, sourceOf(light, eye), any) != 0) continue; // as the z-pass test assures
            if (facesBetween(placed, eye, p, any) != 0) continue;                    // as the depth image assures
            const int entered = -volume.crossings(lists.sides, eye, p);
            const auto count = [&](bool closed) {
                return facesBetween(placed, p, sourceOf(light, p), [&](std::uint32_t face) {
                    return placed.topology.clusterOf(face).closed == closed;
                });
            };
            CHECK(entered == count(true) / 2 + count(false));
            (entered ? shadowed : lit) += 1;
        }
    });
    CHECK(shadowed > 300);
    CHECK(lit > 300);
}

TEST_CASE("of all edges and faces the device draws the sides and caps that the CPU finds")
{
    forAllCases([](const Placed& placed, const LightView& light) {
        const Lists lists(placed, light);
        const DeviceLists device(placed, light);
        CHECK(sums(device.sides) == sums(lists.sides));
        CHECK(counted(device.caps) == counted(lists.caps));
        // With more than two faces at an edge some sides may be drawn both ways; without, nothing is drawn in vain.
        if (placed.topology.manifold) CHECK(counted(device.sides) == counted(lists.sides));
        CHECK(6 * device.sidesLookedAt > lists.sides.size());
    });
}

TEST_CASE("the list of a mesh holds every edge once, whatever stands where")
{
    const Mesh ring = torus(1.0f, 0.35f, 14, 9);
    const Placed closed(ring, glm::mat3(1.0f), glm::vec3(0.0f)), open(holed(ring, 5), glm::mat3(1.0f), glm::vec3(0.0f));
    const EdgeListSize size = edgeListSize(closed.topology);
    CHECK(size.records == closed.topology.edges.size());
    CHECK(size.faces == ring.indices.size() / 3);
    CHECK(size.bytes() <= 117 * size.faces + 64 + 16); // 3/2 records of 24 + 16 bytes, caps of 24 + 16, planes of 16
    CHECK(edgeListSize(open.topology).records >= open.topology.edges.size());
    std::vector<std::uint32_t> first(edgeListSize(open.topology).bytes() / 4), second(first.size());
    writeEdgeList(open.topology, first);
    writeEdgeList(open.topology, second);
    CHECK(first == second);
}

TEST_CASE("a triangle has three sides, a lone quad four, a tetrahedron three or four")
{
    const LightView light = pointLight(glm::vec3(0.2f, 5.0f, 0.1f));
    const Mesh triangle{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {0, 1, 2}};
    const Mesh quad{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}}, {0, 1, 2, 2, 1, 3}};
    const Mesh tetrahedron{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0.3f, 1, 0.3f}}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}};
    for (const bool turned : {false, true}) {
        const auto sides = [&](const Mesh& mesh) {
            const Placed placed(turned ? flipped(mesh, 1) : mesh, glm::mat3(1.0f), glm::vec3(0.0f));
            return Lists(placed, light).sides.size() / 6;
        };
        CHECK(sides(triangle) == 3);
        CHECK(sides(quad) == 4);
        CHECK(sides(tetrahedron) == (turned ? 6 : 3)); // inside out, both sides of its faces count
    }
}

TEST_CASE("the topology of a closed mesh takes 76 bytes a triangle, and nine more where it has several clusters")
{
    const auto bytesOf = [](const Mesh& mesh) {
        const Topology topology = buildTopology(mesh.positions, mesh.indices);
        return topology.edges.capacity() * sizeof(Topology::Edge) +
               topology.uses.capacity() * sizeof(Topology::EdgeUse) +
               (topology.facePlanes.size() + kBlockFaces - 1) / kBlockFaces * sizeof(FaceBlock) +
               topology.faceVerts.capacity() * sizeof(std::uint32_t) + topology.clusterOfFace.capacity() +
               (topology.facesInOrder.capacity() + topology.shellOfFace.capacity()) * sizeof(std::uint32_t);
    };
    for (const std::uint32_t segments : {16u, 64u, 160u}) {
        const Mesh ring = torus(1.0f, 0.35f, segments, segments);
        CHECK(bytesOf(ring) == 76 * ring.indices.size() / 3);
        const Mesh rings = joined(ring, ring, {0.0f, 5.0f, 0.0f});
        CHECK(bytesOf(rings) == 85 * rings.indices.size() / 3);
    }
}

TEST_CASE("a flattened caster still faces the light with one side")
{
    const glm::mat3 flat(1, 0, 0, 0, 0, 0, 0, 0, 1);
    const Placed placed(torus(1.0f, 0.35f, 14, 9), flat, kPlace);
    const Lists lists(placed, pointLight(kPlace + glm::vec3(2, 6, 1)));
    const auto facing = static_cast<std::size_t>(std::count(lists.facing.begin(), lists.facing.end(), 1));
    CHECK(facing > lists.facing.size() / 3);
    CHECK(facing < lists.facing.size() * 2 / 3);
    CHECK(!lists.sides.empty());
}

TEST_CASE("volumes end on a plane behind the whole box, however far away the light is")
{
    Random random(3);
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 a = random.inBox(glm::vec3(-10.0f), glm::vec3(10.0f)), b = random.inBox(a, a + 8.0f);
        const Aabb box{a, b};
        const glm::vec3 c = random.inBox(glm::vec3(-12.0f), glm::vec3(12.0f));
        const Aabb caster{c, c + random.inBox(glm::vec3(0.1f), glm::vec3(3.0f))};
        const glm::vec3 p = random.inBox(caster.lower, caster.upper);
        const bool directional = i % 2 == 0;
        const float away = i % 4 == 1 ? 15.0f : 1e6f;
        const LightView light = directional ? directionalLight(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)))
                                            : pointLight(random.inBox(glm::vec3(-away), glm::vec3(away)));
        const glm::vec4 l = directional ? glm::vec4(light.direction(), 0.0f) : glm::vec4(light.position(), 1.0f);
        const glm::vec4 plane = gpu::extrusionPlane(l, casterReach(caster, light, glm::vec3(0.0f)), a, b);
        if (glm::vec3(plane) == glm::vec3(0.0f)) continue; // the light lies within the caster's bounds on every axis
        ++found;
        const glm::vec3 normal(plane);
        const glm::vec3 farthest = glm::mix(box.lower, box.upper, glm::greaterThan(normal, glm::vec3(0.0f)));
        CHECK(glm::dot(normal, farthest) <= plane.w);
        const glm::vec4 moved = gpu::extruded(p, l, plane);
        CHECK(moved.w > 0.0f);
        const glm::vec3 end = glm::vec3(moved) / moved.w;
        CHECK(glm::dot(normal, end) == doctest::Approx(plane.w).epsilon(1e-3));
        if (!directional) CHECK(glm::dot(end - light.position(), p - light.position()) > 0.0f);
    }
    CHECK(found > 1800);
}

TEST_CASE("keys of floats keep their order and give the float back")
{
    const float values[] = {-1e30f, -2.5f, -1e-30f, 0.0f, 1e-30f, 0.75f, 3.0f, 1e30f};
    for (std::size_t i = 0; i + 1 < std::size(values); ++i) {
        CHECK(gpu::orderedKey(values[i]) < gpu::orderedKey(values[i + 1]));
        CHECK(gpu::fromOrderedKey(gpu::orderedKey(values[i])) == values[i]);
        CHECK(gpu::orderedKey(values[i]) > gpu::EMPTY_UPPER);
        CHECK(gpu::orderedKey(values[i]) < gpu::EMPTY_LOWER);
    }
}
