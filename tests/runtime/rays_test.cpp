// Shadow rays against the brute force: what blocks a ray is the same set of triangles, whatever the packet, the
// instance's transform and the order of updates.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>

#include "runtime/brute_force.hpp"
#include "runtime/ray_fixture.hpp"
#include "runtime/rays/triangle_tree.hpp"
#include "runtime/wavy_sheet.hpp"

using namespace gnomon;
using test::casterOf;
using test::randomRays;
using test::trace;
using test::TracedMesh;
using test::waves;

namespace {

/// The same rays in packets; every seventh is not asked, and its answer taken from `occluded`.
std::vector<std::uint8_t> tracePackets(const RayScene& scene, const std::vector<ShadowRay>& rays,
                                       std::vector<std::uint8_t> occluded, std::uint32_t mask)
{
    constexpr std::size_t width = RayPacket::kWidth;
    std::vector<RayPacket> packets((rays.size() + width - 1) / width);
    for (RayPacket& packet : packets) { // rays that are not there may be anything
        std::memset(static_cast<void*>(&packet), 0xff, sizeof packet);
        std::fill(std::begin(packet.there), std::end(packet.there), 0);
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (i % 7 == 3) continue;
        RayPacket& packet = packets[i / width];
        for (int axis = 0; axis < 3; ++axis) {
            packet.origin[axis][i % width] = rays[i].origin[axis];
            packet.direction[axis][i % width] = rays[i].direction[axis];
        }
        packet.tfar[i % width] = rays[i].tfar;
        packet.there[i % width] = rays[i].tfar < 0.0f ? 0 : -1;
    }
    const std::vector<RayPacket> asked = packets;
    scene.occluded(packets, mask);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const float before = asked[i / width].tfar[i % width], after = packets[i / width].tfar[i % width];
        const bool blocked = after == -std::numeric_limits<float>::infinity();
        if (!blocked) CHECK(std::memcmp(&before, &after, sizeof after) == 0);
        if (i % 7 != 3)
            occluded[i] = blocked;
        else
            CHECK_FALSE(blocked);
    }
    return occluded;
}

enum class Truth { free, blocked, close };

/// The answer in double; `close` where moving the ray by `margin` metres changes it.
Truth truthOf(const brute::Scene& scene, const ShadowRay& ray, double margin = 2e-5)
{
    const glm::dvec3 origin(ray.origin), direction(ray.direction);
    const auto tEnd = static_cast<double>(ray.tfar);
    const bool blocked = scene.blocked(origin, direction, tEnd);
    const glm::dvec3 end = origin + direction * std::min(tEnd, 1e3);
    for (int axis = 0; axis < 6; ++axis) {
        glm::dvec3 move(0.0);
        move[axis % 3] = axis < 3 ? margin : -margin;
        if (scene.blocked(origin + move, direction, tEnd) != blocked) return Truth::close;
        if (scene.blocked(origin, end + move - origin, 1.0) != scene.blocked(origin, end - origin, 1.0))
            return Truth::close;
    }
    return blocked ? Truth::blocked : Truth::free;
}

struct Tally {
    int free = 0, blocked = 0, close = 0, wrong = 0;
};

Tally compare(const brute::Scene& truth, const std::vector<ShadowRay>& rays, const std::vector<std::uint8_t>& occluded)
{
    Tally tally;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Truth expected = truthOf(truth, rays[i]);
        tally.close += expected == Truth::close;
        tally.free += expected == Truth::free;
        tally.blocked += expected == Truth::blocked;
        tally.wrong += expected != Truth::close && occluded[i] != (expected == Truth::blocked ? 1 : 0);
    }
    return tally;
}

/// Rays one by one and in packets agree with the truth, and the rays are a mixture that could tell.
void checkAgainstTruth(const RayScene& scene, const std::vector<Caster>& casters, const std::vector<ShadowRay>& rays,
                       std::uint32_t mask = 0xffffffffu)
{
    const brute::Scene truth(brute::trianglesOf(casters, mask));
    const std::vector<std::uint8_t> answers = trace(scene, rays, mask);
    CHECK(tracePackets(scene, rays, answers, mask) == answers);
    const Tally tally = compare(truth, rays, answers);
    CAPTURE(tally.close);
    CHECK(tally.wrong == 0);
    CHECK(tally.free > static_cast<int>(rays.size()) / 20);
    CHECK(tally.blocked > static_cast<int>(rays.size()) / 20);
    CHECK(tally.close < static_cast<int>(rays.size()) / 50);
}

glm::mat3 randomBasis(std::mt19937& random, bool mirrored)
{
    glm::mat3 basis;
    do {
        for (int column = 0; column < 3; ++column)
            basis[column] = test::randomPoint(random, 1.5f);
    } while (std::abs(glm::determinant(basis)) < 0.3f || (glm::determinant(basis) < 0.0f) != mirrored);
    return basis;
}

} // namespace

TEST_CASE("a ray is blocked by exactly the triangles that block it in double precision")
{
    std::mt19937 random(1);
    RayScene scene;
    const TracedMesh mesh(scene, test::randomTriangles(random, 2000, 10.0f, 0.5f));
    REQUIRE(mesh.rays);
    const std::vector<Caster> casters{casterOf(mesh, 7)};
    scene.update(casters);
    checkAgainstTruth(scene, casters, randomRays(random, 20000, 12.0f));
}

TEST_CASE("mirrored, sheared and scaled instances block where their world triangles are")
{
    std::mt19937 random(2);
    RayScene scene;
    const TracedMesh a(scene, test::randomTriangles(random, 200, 2.0f, 0.5f));
    const TracedMesh b(scene, test::randomTriangles(random, 100, 2.0f, 0.7f));
    std::vector<Caster> casters;
    for (std::uint32_t i = 0; i < 30; ++i)
        casters.push_back(casterOf(i % 2 ? a : b, i, randomBasis(random, i % 3 == 0), test::randomPoint(random, 8.0f)));
    scene.update(casters);
    checkAgainstTruth(scene, casters, randomRays(random, 10000, 12.0f));
}

TEST_CASE("every count of rays, full packets or not, is answered ray by ray")
{
    std::mt19937 random(3);
    RayScene scene;
    const TracedMesh mesh(scene, test::randomTriangles(random, 300, 5.0f, 1.0f));
    scene.update(std::vector<Caster>{casterOf(mesh, 0)});
    const std::vector<ShadowRay> all = randomRays(random, 600, 6.0f);
    const std::vector<std::uint8_t> expected = trace(scene, all);
    for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 31u, 255u, 256u, 257u, 511u, 600u}) {
        const std::vector<ShadowRay> some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
        const std::vector<std::uint8_t> head(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(count));
        CHECK(trace(scene, some) == head);
    }
}

TEST_CASE("a ray ends at tfar and starts at its origin")
{
    RayScene scene;
    const TracedMesh wall(scene, {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}});
    scene.update(std::vector<Caster>{casterOf(wall, 0)});
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<ShadowRay> rays{
        {{0, 0, 1}, infinity, {0, 0, -1}},  // through it
        {{0, 0, 1}, 0.999f, {0, 0, -1}},    // stops short
        {{0, 0, 1}, 1.001f, {0, 0, -1}},    // just reaches it
        {{0, 0, 1}, 0.501f, {0, 0, -2}},    // tfar counts in lengths of the direction
        {{0, 0, 1}, infinity, {0, 0, 1}},   // away
        {{0, 0, -1}, infinity, {0, 0, 1}},  // from behind: no face is culled
        {{0, 0, 1}, -1.0f, {0, 0, -1}},     // an offset longer than the way to the light: nothing between
        {{3, 0, 1}, infinity, {0, 0, -1}}}; // beside it
    const std::vector<std::uint8_t> expected{1, 0, 1, 1, 0, 1, 0, 0};
    CHECK(trace(scene, rays) == expected);
}

TEST_CASE("a caster blocks the lights whose mask it shares, and no others")
{
    std::mt19937 random(4);
    RayScene scene;
    const TracedMesh mesh(scene, test::randomTriangles(random, 300, 3.0f, 0.6f));
    std::vector<Caster> casters;
    for (std::uint32_t i = 0; i < 6; ++i) {
        casters.push_back(casterOf(mesh, i, randomBasis(random, false), test::randomPoint(random, 4.0f)));
        casters.back().mask = 1u << i;
    }
    casters[5].mask = 0x80000001u;
    scene.update(casters);
    const std::vector<ShadowRay> rays = randomRays(random, 2000, 7.0f);
    for (const std::uint32_t mask : {0x1u, 0x6u, 0x80000000u, 0xffffffffu})
        checkAgainstTruth(scene, casters, rays, mask);
    for (const std::uint8_t occluded : trace(scene, rays, 0x100u))
        REQUIRE(occluded == 0);
}

TEST_CASE("update follows casters that move, come, go and change their mesh")
{
    std::mt19937 random(5);
    RayScene scene;
    const TracedMesh a(scene, test::randomTriangles(random, 400, 4.0f, 0.6f));
    auto b = std::make_unique<TracedMesh>(scene, test::randomTriangles(random, 300, 4.0f, 0.8f));
    const std::vector<ShadowRay> rays = randomRays(random, 3000, 8.0f);
    std::vector<Caster> casters{casterOf(a, 10), casterOf(*b, 11, glm::mat3(1.0f), {3, 0, 0}),
                                casterOf(a, 12, glm::mat3(1.0f), {-4, 0, 0})};
    scene.update(casters);
    checkAgainstTruth(scene, casters, rays);

    casters[1].translation = {0, 2, -3};
    scene.update(casters);
    checkAgainstTruth(scene, casters, rays);

    std::swap(casters[0], casters[2]); // another order is the same scene
    scene.update(casters);
    checkAgainstTruth(scene, casters, rays);

    casters.erase(casters.begin());
    scene.update(casters);
    checkAgainstTruth(scene, casters, rays);

    casters.push_back(casterOf(a, 20, glm::mat3(0.5f), {1, 1, 1})); // takes the place that became free
    casters[0].mesh = &a.view;
    scene.update(casters);
    b.reset(); // no longer used by any caster
    checkAgainstTruth(scene, casters, rays);

    MeshView building = a.view; // its tree is not there yet
    building.rays = nullptr;
    casters.back().mesh = &building;
    scene.update(casters);
    casters.pop_back();
    checkAgainstTruth(scene, casters, rays);

    scene.update({});
    for (const std::uint8_t occluded : trace(scene, rays))
        REQUIRE(occluded == 0);
}

TEST_CASE("trees handed on from revision to revision answer like built ones, and take no more memory")
{
    constexpr std::uint32_t side = 24;
    std::mt19937 random(9);
    RayScene scene, fresh;
    MeshRaysHistory history;
    const std::vector<std::uint32_t> indices = test::sheetTriangles(side);
    const std::vector<ShadowRay> rays = randomRays(random, 1000, 1.2f);
    std::deque<std::unique_ptr<TracedMesh>> inFlight; // three frames still look at their own
    std::size_t settled = 0;
    for (int revision = 0; revision < 24; ++revision) {
        CAPTURE(revision);
        const float phase = 0.2f * float(revision);
        inFlight.push_back(std::make_unique<TracedMesh>(scene, waves(side, phase), indices, history));
        if (inFlight.size() > 3) inFlight.pop_front();
        // The first is not movable; four more are built before one of those is looked at no longer.
        CHECK(inFlight.back()->rays->moved() == (revision > 4));
        const TracedMesh built(fresh, waves(side, phase), indices);
        const std::vector<Caster> casters{casterOf(*inFlight.back(), 1)}, same{casterOf(built, 1)};
        scene.update(casters);
        fresh.update(same);
        CHECK(trace(scene, rays) == trace(fresh, rays));
        if (revision == 0) checkAgainstTruth(scene, casters, rays);
        if (revision == 12) settled = scene.memoryBytes();
        if (revision > 12) CHECK(scene.memoryBytes() == settled);
    }
    checkAgainstTruth(scene, {casterOf(*inFlight.back(), 1)}, rays);
}

TEST_CASE("a tree whose triangles have parted is built again")
{
    constexpr std::uint32_t side = 24;
    std::mt19937 random(10);
    RayScene scene;
    MeshRaysHistory history;
    const std::vector<std::uint32_t> indices = test::sheetTriangles(side);
    const TracedMesh sheet(scene, waves(side, 0.0f), indices, history);
    const TracedMesh moved(scene, waves(side, 1.0f), indices, history);
    const auto sameShape = [](const TracedMesh& a, const TracedMesh& b) {
        return std::ranges::equal(a.rays->tree()->triangles(), b.rays->tree()->triangles());
    };
    CHECK(sameShape(sheet, moved));
    std::vector<glm::vec3> corners = waves(side, 0.0f); // every corner somewhere else on the sheet
    std::ranges::shuffle(corners, random);
    const TracedMesh torn(scene, corners, indices, history);
    CHECK_FALSE(sameShape(sheet, torn));
    CHECK_FALSE(torn.rays->tree()->worn());
    CHECK_FALSE(torn.rays->moved());
    const std::vector<Caster> casters{casterOf(torn, 1)};
    scene.update(casters);
    checkAgainstTruth(scene, casters, randomRays(random, 1000, 1.2f));
}

TEST_CASE("an alpha-tested caster blocks where its opacity is at least one half, others as before")
{
    struct Seen {
        std::uint32_t triangle;
        float u, v;
    };
    static thread_local Seen last{};
    RayScene scene;
    const TracedMesh square(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}});
    std::vector<Caster> casters{casterOf(square, 3), casterOf(square, 4, glm::mat3(1.0f), {5, 0, 0})};
    casters[0].alphaTested = true;
    float threshold = 0.25f;
    casters[0].userData = &threshold;
    casters[0].opacity = [](std::uint32_t triangle, float u, float v, void* data) {
        last = {triangle, u, v};
        return u >= *static_cast<float*>(data) ? 0.5f : 0.499f;
    };
    scene.update(casters);
    const auto blockedAt = [&](float x, float y) {
        const std::vector<ShadowRay> ray{{{x, y, 1}, 10.0f, {0, 0, -1}}};
        return trace(scene, ray)[0] == 1;
    };
    CHECK(blockedAt(0.3f, 0.2f));
    CHECK(last.triangle == 0);
    CHECK(last.u == doctest::Approx(0.3).epsilon(1e-4));
    CHECK(last.v == doctest::Approx(0.2).epsilon(1e-4));
    CHECK_FALSE(blockedAt(0.2f, 0.3f));
    CHECK(blockedAt(0.7f, 0.9f)); // second triangle: u runs from (1, 1) to (0, 1)
    CHECK(last.triangle == 1);
    CHECK(last.u == doctest::Approx(0.3).epsilon(1e-4));
    CHECK(blockedAt(5.1f, 0.1f)); // the same mesh without opacity

    // The host gave five triangles; three have no area and have gone.
    MeshView renumbered = *casters[0].mesh;
    const std::uint32_t given[] = {1, 4};
    renumbered.givenNumbers = given;
    renumbered.revision += 1000;
    casters[0].mesh = &renumbered;
    scene.update(casters);
    CHECK(blockedAt(0.3f, 0.2f));
    CHECK(last.triangle == 1);
    CHECK(blockedAt(0.7f, 0.9f));
    CHECK(last.triangle == 4);

    casters.push_back(casterOf(square, 5, glm::mat3(1.0f), {0, 0, -1})); // behind the hole
    scene.update(casters);
    CHECK(blockedAt(0.2f, 0.3f));
}

TEST_CASE("instances without an inverse block nothing and harm nothing")
{
    std::mt19937 random(6);
    RayScene scene;
    const TracedMesh mesh(scene, test::randomTriangles(random, 400, 4.0f, 0.6f));
    glm::mat3 flat(1.0f);
    flat[1] = glm::vec3(0.0f);
    std::vector<Caster> casters{casterOf(mesh, 0)};
    std::vector<Caster> both{casterOf(mesh, 0), casterOf(mesh, 1, flat)};
    scene.update(both);
    checkAgainstTruth(scene, casters, randomRays(random, 2000, 6.0f));
}

TEST_CASE("instances all but flat block nothing and harm nothing, small ones block as others")
{
    std::mt19937 random(8);
    const std::vector<glm::vec3> corners = test::randomTriangles(random, 400, 4.0f, 0.6f);
    const std::vector<ShadowRay> rays = randomRays(random, 2000, 6.0f);
    for (const float thin : {1e-3f, 1e-12f, 1e-15f, 1e-19f, 1e-30f}) {
        CAPTURE(thin);
        RayScene scene;
        const TracedMesh mesh(scene, corners);
        std::vector<glm::vec3> large = corners;
        for (glm::vec3& corner : large)
            corner.y /= thin;
        const glm::mat3 basis(glm::vec3(1.0f, 0.0f, 0.0f), glm::vec3(0.0f, thin, 0.0f), glm::vec3(0.0f, 0.0f, 1.0f));
        const TracedMesh tall(scene, large);
        const bool asked = thin > 1e-9f; // times 10^9 m is 10^18 m there
        const std::vector<Caster> both{casterOf(mesh, 0), casterOf(asked ? tall : mesh, 1, basis)};
        scene.update(both);
        CHECK(castsRays(both[1]) == asked);
        checkAgainstTruth(scene, {casterOf(mesh, 0)}, rays);
    }
}

TEST_CASE("nothing blocks rays that start out of reach or are no numbers, and those beside them are answered")
{
    std::mt19937 random(9);
    RayScene scene;
    const TracedMesh mesh(scene, test::randomTriangles(random, 400, 4.0f, 0.6f));
    scene.update(std::vector<Caster>{casterOf(mesh, 0)});
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const std::vector<ShadowRay> all = randomRays(random, 2048, 6.0f);
    const std::vector<std::uint8_t> expected = trace(scene, all);
    for (const float wild : {1e19f, -3e38f, infinity, -infinity, nan, 1e18f, 1e17f}) {
        CAPTURE(wild);
        std::vector<ShadowRay> rays = all;
        std::vector<std::uint8_t> answers = expected;
        for (std::size_t i = 0; i < rays.size(); i += 5) {
            (i % 2 == 0 ? rays[i].origin : rays[i].direction)[static_cast<int>(i / 5 % 3)] = wild;
            if (i % 3 == 0) rays[i].tfar = i % 9 == 0 ? nan : infinity;
            answers[i] = 0;
        }
        const auto check = [&](std::vector<std::uint8_t> occluded) {
            for (std::size_t i = 0; i < occluded.size(); ++i) {
                const bool within = std::abs(wild) <= 1e18f && i % 5 == 0; // asked, and may be blocked
                if (occluded[i] != answers[i] && !within) return i;
            }
            return occluded.size();
        };
        CHECK(check(trace(scene, rays)) == rays.size());
        CHECK(check(tracePackets(scene, rays, trace(scene, rays), 0xffffffffu)) == rays.size());
    }
}
