// Silhouettes, caps and extrusion of shadow volumes against brute force in double precision.
#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <map>

#include "algorithms/volumes/edge_list.hpp"
#include "runtime/scene/light_fit.hpp"
#include "shaders/volumes/all_edges.h"
#include "shaders/volumes/volume.h"
#include "tests/algorithms/volume_lists.hpp"

#include "algorithms/volumes/shadow_reach.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// What a device draws of the list of all edges and faces, as indices of the same kind.
struct DeviceLists {
    std::vector<std::uint32_t> sides, caps;
    std::size_t sidesLookedAt = 0;

    DeviceLists(const Placed& placed, const LightView& light)
        : placed_(placed), light_(lightInObjectSpace(light, placed.caster)),
          words_(edgeListSize(placed.topology).bytes() / 4)
    {
        writeEdgeList(placed.topology, words_);
        for (const std::uint32_t command : {kPairCommand, kBorderCommand})
            draw(command, sides);
        sidesLookedAt = looked_;
        draw(kCapCommand, caps);
        REQUIRE(largest_ < edgeListSize(placed.topology).largestIndex());
    }

private:
    gpu::uvec4 slot(std::uint32_t index) const
    {
        REQUIRE(4 * index + 3 < words_.size());
        return {words_[4 * index], words_[4 * index + 1], words_[4 * index + 2], words_[4 * index + 3]};
    }
    std::uint32_t wayOf(std::uint32_t plane) const
    {
        const gpu::uvec4 bits = slot(plane);
        const glm::vec4 values(std::bit_cast<float>(bits.x), std::bit_cast<float>(bits.y), std::bit_cast<float>(bits.z),
                               std::bit_cast<float>(bits.w));
        return gpu::faceWay(values, light_);
    }
    std::uint32_t sideAt(std::uint32_t index, std::uint32_t instance) const
    {
        const gpu::uvec4 edge = slot(index >> 2);
        return gpu::sideCorner(edge, wayOf(edge.z >> 1), wayOf(edge.w >> 1), instance, index & 3);
    }
    std::uint32_t capAt(std::uint32_t index) const
    {
        const std::uint32_t away = placed_.caster.mirrored ? gpu::FACE_TOWARDS : gpu::FACE_AWAY;
        const gpu::uvec4 face = slot(index >> 3);
        return gpu::capCorner(face, wayOf(face.w), placed_.topology.closed ? away : gpu::FACE_TOUCHED, (index >> 2) & 1,
                              index & 3);
    }
    void draw(std::uint32_t command, std::vector<std::uint32_t>& out)
    {
        const std::uint32_t count = words_[5 * command], instances = words_[5 * command + 1];
        const std::uint32_t first = words_[5 * command + 2];
        REQUIRE(first + count <= words_.size());
        for (std::uint32_t instance = 0; instance < instances; ++instance)
            for (std::uint32_t i = first; i < first + count; i += 6) {
                std::array<std::uint32_t, 6> corners{};
                for (std::uint32_t k = 0; k < 6; ++k) {
                    largest_ = std::max<std::uint64_t>(largest_, words_[i + k]);
                    corners[k] = command == kCapCommand ? capAt(words_[i + k]) : sideAt(words_[i + k], instance);
                }
                ++looked_;
                const auto gone = std::count(corners.begin(), corners.end(), gpu::NO_CORNER);
                CHECK((gone == 0 || gone == 6));
                if (gone == 0) out.insert(out.end(), corners.begin(), corners.end());
            }
    }

    const Placed& placed_;
    gpu::FaceLight light_;
    std::vector<std::uint32_t> words_;
    std::size_t looked_ = 0;
    std::uint64_t largest_ = 0;
};

using SixCorners = std::array<std::uint32_t, 6>;

/// How often each six indices occur.
std::map<SixCorners, int> counted(const std::vector<std::uint32_t>& indices)
{
    std::map<SixCorners, int> counts;
    for (std::size_t i = 0; i < indices.size(); i += 6) {
        SixCorners corners{};
        std::copy_n(&indices[i], 6, corners.begin());
        ++counts[corners];
    }
    return counts;
}

/// How often each directed edge has a side, less how often the same one has it the other way round.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> sums(const std::vector<std::uint32_t>& sides)
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sum;
    for (std::size_t i = 0; i < sides.size(); i += 6) {
        const std::uint32_t a = sides[i], b = sides[i + 5];
        sum[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
    std::erase_if(sum, [](const auto& entry) { return entry.second == 0; });
    return sum;
}

/// Whether as many sides leave every vertex as come to it.
bool loopsAreClosed(const std::vector<std::uint32_t>& sides)
{
    std::map<std::uint32_t, int> balance; // edges out minus edges in, by vertex
    for (std::size_t i = 0; i < sides.size(); i += 6) {
        CHECK(sides[i] % 2 == 0);
        CHECK(sides[i + 5] % 2 == 0);
        ++balance[sides[i]];
        --balance[sides[i + 5]];
    }
    return std::all_of(balance.begin(), balance.end(), [](const auto& entry) { return entry.second == 0; });
}

/// A caster's volume as triangles in the world.
struct Volume {
    std::vector<glm::dvec3> corners; ///< By index: 2 * vertex + copy.
    glm::vec4 plane;

    Volume(const Placed& placed, const LightView& light, const Aabb& box)
    {
        const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
        const glm::vec4 l = directional ? glm::vec4(light.direction(), 0.0f) : glm::vec4(light.position(), 1.0f);
        plane = gpu::extrusionPlane(l, casterReach(placed.caster.bounds, light, glm::vec3(0.0f)), box.lower, box.upper);
        for (std::uint32_t v = 0; v < placed.mesh.positions.size(); ++v) {
            const glm::vec3 near = placed.world(v);
            const glm::vec4 moved = gpu::extruded(near, l, plane);
            corners.emplace_back(near);
            corners.emplace_back(glm::dvec3(moved) / static_cast<double>(moved.w));
        }
    }

    /// Moved by a length that stands for infinity.
    Volume(const Placed& placed, glm::dvec3 lamp)
    {
        for (std::uint32_t v = 0; v < placed.mesh.positions.size(); ++v) {
            corners.emplace_back(placed.world(v));
            corners.emplace_back(lamp + 1e5 * (corners.back() - lamp));
        }
    }

    int crossings(std::span<const std::uint32_t> indices, glm::dvec3 from, glm::dvec3 to) const
    {
        int sum = 0;
        for (std::size_t i = 0; i < indices.size(); i += 3)
            sum += crossing(from, to, corners[indices[i]], corners[indices[i + 1]], corners[indices[i + 2]]);
        return sum;
    }
};

/// Faces that a segment meets; `chosen` says which count.
template <typename Chosen>
int facesBetween(const Placed& placed, glm::dvec3 from, glm::dvec3 to, Chosen&& chosen)
{
    int count = 0;
    for (std::uint32_t face = 0; face < placed.topology.facePlanes.size(); ++face) {
        const std::uint32_t* v = &placed.topology.faceVerts[3 * face];
        if (chosen(face) && crossing(from, to, placed.world(v[0]), placed.world(v[1]), placed.world(v[2])) != 0)
            ++count;
    }
    return count;
}

struct Case {
    const char* name;
    Mesh mesh;
    bool closed;
};

std::vector<Case> cases()
{
    const Mesh ring = torus(1.0f, 0.35f, 14, 9);
    Mesh twice = ring; // every edge four times: closed, yet not manifold
    twice.indices.insert(twice.indices.end(), ring.indices.begin(), ring.indices.end());
    return {{"torus", ring, true},
            {"torus twice", twice, true},
            {"torus inside out", flipped(ring, 1), true},
            {"holed torus", holed(ring, 5), false},
            {"torus with flipped faces", flipped(ring, 7), false},
            {"torus with fins", finned(ring, 11), false},
            {"sheet", sheet(8, 0.3f), false},
            {"sheet with flipped faces and fins", finned(flipped(sheet(8, 0.3f), 3), 9), false}};
}

std::vector<glm::mat3> bases()
{
    const glm::mat3 turned(glm::rotate(glm::mat4(1.0f), 0.7f, glm::normalize(glm::vec3(1, 2, 3))));
    return {turned, turned * glm::mat3(1, 0, 0, 0, -1, 0, 0, 0, 1),  // mirrored
            turned * glm::mat3(2, 0, 0, 0.5f, 0.3f, 0, 0, 0.4f, 1)}; // scaled and sheared
}

const glm::vec3 kPlace(3.0f, 1.0f, -2.0f);

std::vector<LightView> lights()
{
    return {pointLight(kPlace + glm::vec3(2, 6, 1)), pointLight(kPlace + glm::vec3(-7, 1.5f, 3)),
            directionalLight(glm::vec3(0.3f, -1.0f, 0.2f)), directionalLight(glm::vec3(-1.0f, -0.2f, 0.5f))};
}

template <typename Body>
void forAllCases(Body&& body)
{
    for (const Case& c : cases())
        for (const glm::mat3& basis : bases())
            for (const LightView& light : lights()) {
                CAPTURE(c.name);
                CAPTURE(glm::determinant(basis));
                CAPTURE(static_cast<int>(light.type));
                const Placed placed(c.mesh, basis, kPlace);
                REQUIRE(placed.topology.closed == c.closed);
                body(placed, light);
            }
}

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

const Aabb kBox{kPlace - 5.0f, kPlace + 5.0f};

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
        const std::uint8_t away = placed.caster.mirrored ? 1 : 0;
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 p = receiver(placed, light, random);
            const glm::dvec3 source = sourceOf(light, p);
            const glm::dvec3 outside = p + 1000.0 * glm::dvec3(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
            const int wound = volume.crossings(lists.sides, p, outside) + volume.crossings(lists.caps, p, outside);
            const int expected = facesBetween(placed, p, source, [&](std::uint32_t face) {
                return !placed.topology.closed || lists.facing[face] == away;
            });
            CHECK(wound == expected);
            (expected ? shadowed : lit) += 1;
        }
    });
    CHECK(shadowed > 500);
    CHECK(lit > 500);
}

TEST_CASE("a face that the light touches stops none of its light")
{
    Random random(13);
    int shadowed = 0, lit = 0;
    forTouchedCases([&](const Placed& placed, const LightView& light, std::size_t touched) {
        const Lists lists(placed, light);
        CHECK(!blocksLight(placed.topology, lists.facing[touched], placed.caster.mirrored));
        const Volume volume(placed, glm::dvec3(light.position()));
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 p = random.inBox(kBox.lower, kBox.upper);
            const glm::dvec3 outside = p + 1e7 * glm::dvec3(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
            const int wound = volume.crossings(lists.sides, p, outside) + volume.crossings(lists.caps, p, outside);
            const int expected = facesBetween(placed, p, glm::dvec3(light.position()), [&](std::uint32_t face) {
                return blocksLight(placed.topology, lists.facing[face], placed.caster.mirrored);
            });
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
            const int faces = facesBetween(placed, p, sourceOf(light, p), any);
            CHECK(entered == (placed.topology.closed ? faces / 2 : faces));
            (faces ? shadowed : lit) += 1;
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
        CHECK(sides(tetrahedron) == 3);
    }
}

TEST_CASE("the topology of a closed mesh takes 76 bytes a triangle")
{
    for (const std::uint32_t segments : {16u, 64u, 160u}) {
        const Mesh ring = torus(1.0f, 0.35f, segments, segments);
        const Topology topology = buildTopology(ring.positions, ring.indices);
        const std::size_t bytes = topology.edges.capacity() * sizeof(Topology::Edge) +
                                  topology.uses.capacity() * sizeof(Topology::EdgeUse) +
                                  (topology.facePlanes.size() + kBlockFaces - 1) / kBlockFaces * sizeof(FaceBlock) +
                                  topology.faceVerts.capacity() * sizeof(std::uint32_t);
        CHECK(bytes == 76 * ring.indices.size() / 3);
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

TEST_CASE("volumes end on a plane behind the whole box")
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
        const LightView light = directional ? directionalLight(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)))
                                            : pointLight(random.inBox(glm::vec3(-15.0f), glm::vec3(15.0f)));
        const glm::vec4 l = directional ? glm::vec4(light.direction(), 0.0f) : glm::vec4(light.position(), 1.0f);
        const glm::vec4 plane = gpu::extrusionPlane(l, casterReach(caster, light, glm::vec3(0.0f)), a, b);
        if (glm::vec3(plane) == glm::vec3(0.0f)) continue; // the light lies within the caster's bounds on every axis
        ++found;
        const glm::vec3 normal(plane);
        const glm::vec3 farthest = glm::mix(box.lower, box.upper, glm::greaterThan(normal, glm::vec3(0.0f)));
        CHECK(glm::dot(normal, farthest) <= plane.w + 1e-3f);
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
