// The CPU's receivers and rays against the brute force: views near and far from the world's zero, both kinds of depth,
// all kinds of light.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "algorithms/hybrid_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Tally {
    int asked = 0, lit = 0, dark = 0, unreached = 0, grazing = 0, ambiguous = 0;
    int wrong = 0;          ///< Among light-facing, non-grazing, unambiguous pixels.
    int wrongAmbiguous = 0; ///< Among ambiguous ones, not grazing.
    int otherState = 0;     ///< Asked where the truth does not ask, or the opposite.
    int wrongAtEdges = 0;   ///< Without normals: beside a pixel of another surface, which is taken for the receiver's.
};

/// Whether a pixel beside this one shows another surface.
bool atEdge(const Seen& seen, int x, int y)
{
    const auto normal = [&](int column, int row) { return seen.normals[std::size_t(row * kWidth + column)]; };
    return (x > 0 && normal(x - 1, y) != normal(x, y)) || (x + 1 < kWidth && normal(x + 1, y) != normal(x, y)) ||
           (y > 0 && normal(x, y - 1) != normal(x, y)) || (y + 1 < kHeight && normal(x, y + 1) != normal(x, y));
}

Tally compare(const Seen& seen, const LightPair& light, const brute::Scene& truth, const RayScene& rays)
{
    const bool normals = seen.view.normalFormat != VK_FORMAT_UNDEFINED;
    const Receivers receivers(seen.view, light.view, seen.depth,
                              normals ? seen.normalBytes() : std::span<const std::byte>());
    Tally tally;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const auto pixel = static_cast<std::size_t>(y * kWidth + x);
            const glm::dvec3 normal(glm::vec3(seen.normals[pixel]));
            const brute::Answer answer =
                brute::answerAt(seen.truth, light.truth, truth, x, y, seen.depth[pixel], normal, normals);
            ShadowRay ray;
            const Asked asked = receivers.at(std::uint32_t(x), std::uint32_t(y), ray);
            const bool traced = answer.state == brute::State::asked;
            tally.otherState += (asked == Asked::ray) != traced && !answer.grazing;
            tally.unreached += answer.state == brute::State::unreached;
            tally.dark += asked == Asked::dark;
            if (!traced || asked != Asked::ray) continue;
            ++tally.asked;
            tally.grazing += answer.grazing;
            tally.lit += answer.lit;
            std::uint8_t occluded = 2;
            rays.occluded({&ray, 1}, 1u, {&occluded, 1});
            const bool wrong = (occluded == 0) != answer.lit;
            if (answer.grazing) continue;
            tally.ambiguous += answer.ambiguous;
            if (!normals && atEdge(seen, x, y)) {
                tally.wrongAtEdges += wrong && !answer.ambiguous;
                continue;
            }
            tally.wrong += wrong && !answer.ambiguous;
            tally.wrongAmbiguous += wrong && answer.ambiguous;
        }
    }
    return tally;
}

void check(const Tally& t)
{
    MESSAGE("asked " << t.asked << ", lit " << t.lit << ", facing away " << t.dark << ", out of reach " << t.unreached
                     << ", grazing " << t.grazing << ", ambiguous " << t.ambiguous << " (" << t.wrongAmbiguous
                     << " differ), wrong " << t.wrong << ", other state " << t.otherState);
    CHECK(t.wrong <= 2);
    CHECK(t.otherState <= 2);
    CHECK(t.asked > 3000);
    CHECK(t.lit > t.asked / 4);
    CHECK(t.lit < t.asked * 19 / 20);
    CHECK(t.ambiguous < t.asked / 20);
}

void checkAllLights(const Camera& camera)
{
    RayScene rays;
    const TracedMesh mesh = makeScene(rays);
    const std::vector<Caster> casters{test::casterOf(mesh, 0)};
    rays.update(casters);
    const std::vector<brute::Triangle> triangles = brute::trianglesOf(casters);
    const brute::Scene truth(triangles);
    const Seen seen = look(camera, triangles);
    SUBCASE("directional")
    {
        check(compare(seen, makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.4, -1.0, -0.3}, 0.0, 0.0), truth, rays));
    }
    SUBCASE("spot")
    {
        const Tally t =
            compare(seen, makeLight(GN_LIGHT_TYPE_SPOT, {2, 12, 6}, {-0.2, -1, -0.5}, 40, 0.6), truth, rays);
        check(t);
        CHECK(t.unreached > 500);
    }
    SUBCASE("point")
    {
        check(compare(seen, makeLight(GN_LIGHT_TYPE_POINT, {1, 3.2, 3}, {0, -1, 0}, 25, 0.0), truth, rays));
    }
}

} // namespace

TEST_CASE("reversed depth: no unambiguous pixel differs from the brute force, give or take two")
{
    checkAllLights({});
}

TEST_CASE("standard depth differs no more, at three times the offset")
{
    checkAllLights({.convention = GN_DEPTH_STANDARD});
}

TEST_CASE("a scene 200 km from the world's zero is answered as exactly")
{
    checkAllLights({.place = {200704.0, 0.0, -102400.0}});
}

TEST_CASE("without normals every reached pixel is asked")
{
    RayScene rays;
    const TracedMesh mesh = makeScene(rays);
    const std::vector<Caster> casters{test::casterOf(mesh, 0)};
    rays.update(casters);
    const std::vector<brute::Triangle> triangles = brute::trianglesOf(casters);
    const Seen seen = look({.normals = false}, triangles);
    const Tally t =
        compare(seen, makeLight(GN_LIGHT_TYPE_POINT, {1, 9, 3}, {0, -1, 0}, 25, 0.0), brute::Scene(triangles), rays);
    CHECK(t.dark == 0);
    CHECK(t.otherState <= 2);
    CHECK(t.wrong <= 2);
    CHECK(t.wrongAtEdges <= t.asked / 1000);
    CHECK(t.asked > 10000);
}

TEST_CASE(
    "without normals a floor that a rasteriser puts half a subpixel off does not shadow itself, however flat the light")
{
    RayScene rays;
    const TracedMesh floor(rays, {{-90, 0, -90}, {0, 0, 180}, {90, 0, -90}});
    const std::vector<Caster> casters{test::casterOf(floor, 0)};
    rays.update(casters);
    Seen seen = look({.normals = false}, brute::trianglesOf(casters));
    const gpu::ViewConstants& view = seen.view.constants;
    const std::vector<float> exact = seen.depth;
    int asked = 0, blocked = 0;
    for (const float off : {-1.0f / 512.0f, 0.0f, 1.0f / 512.0f}) { // of a pixel: vertices are snapped to 1/256
        for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
            if (exact[i] == view.skyDepth) continue;
            const glm::vec2 place(static_cast<float>(i % kWidth) + 0.5f, static_cast<float>(i / kWidth) + 0.5f + off);
            const float w = -view.eyeWs.y / gpu::viewRayWs(view, place).y;
            seen.depth[i] = (view.depthScale / w - view.depthAdd) / view.depthMul;
        }
        for (int turn = 0; turn < 8; ++turn) {
            const double angle = 0.7 + 0.785 * turn;
            const LightPair sun =
                makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {std::cos(angle), -0.05, std::sin(angle)}, 0.0, 0.0);
            const Receivers receivers(seen.view, sun.view, seen.depth, {});
            for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
                ShadowRay ray;
                if (receivers.at(i % kWidth, i / kWidth, ray) != Asked::ray) continue;
                std::uint8_t occluded = 2;
                rays.occluded({&ray, 1}, 1u, {&occluded, 1});
                ++asked;
                blocked += occluded;
            }
        }
    }
    CHECK(asked > 100000);
    CHECK(blocked == 0); // a third of those asked where rays start moved towards the light alone
}

TEST_CASE("outside of what a light's bounds cover no pixel asks, and none is dark")
{
    RayScene rays;
    const TracedMesh mesh = makeScene(rays);
    const std::vector<Caster> casters{test::casterOf(mesh, 0)};
    const std::vector<brute::Triangle> triangles = brute::trianglesOf(casters);
    const Seen seen = look({}, triangles);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int outside = 0, asking = 0, whole = 0;
    for (int i = 0; i < 60; ++i) {
        const glm::dvec3 at(8.0 * unit(random), 2.5 + 2.0 * unit(random), 8.0 * unit(random));
        const double range = 3.0 + 2.0 * unit(random);
        const LightPair light = i % 2 ? makeLight(GN_LIGHT_TYPE_POINT, at, {0, -1, 0}, range, 0.0)
                                      : makeLight(GN_LIGHT_TYPE_SPOT, at, {unit(random), -1, unit(random)}, range, 0.4);
        const Receivers receivers(seen.view, light.view, seen.depth, seen.normalBytes());
        const AskedPixels part = askedPixels(seen.view, light.view, 4);
        CHECK(part.left % 4 == 0);
        CHECK(part.top % 4 == 0);
        CHECK(part.right <= kWidth);
        CHECK(part.bottom <= kHeight);
        whole += part.left == 0 && part.top == 0 && part.right == kWidth && part.bottom == kHeight;
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 0; x < kWidth; ++x) {
                ShadowRay ray;
                const bool lit = receivers.at(x, y, ray) == Asked::lit;
                asking += !lit;
                if (part.holdsRow(y) && part.left <= x && x < part.right) continue;
                ++outside;
                REQUIRE(lit);
            }
    }
    MESSAGE(outside << " pixels outside, " << asking << " ask, " << whole << " of 60 lights cover all");
    CHECK(outside > 60 * kWidth * kHeight / 4);
    CHECK(asking > 60 * kWidth * kHeight / 100);
}

TEST_CASE("a receiver closer to the light than the offset is lit")
{
    RayScene rays;
    const TracedMesh wall(rays, {{-20, 0, -20}, {0, 0, 40}, {20, 0, -20}});
    const std::vector<Caster> casters{test::casterOf(wall, 0)};
    rays.update(casters);
    const std::vector<brute::Triangle> triangles = brute::trianglesOf(casters);
    Seen seen = look({.eye = {0.0, 30.0, 0.1}}, triangles);
    const brute::View& v = seen.truth;
    const brute::Answer middle = brute::answerAt(v, {}, brute::Scene({}), kWidth / 2, kHeight / 2,
                                                 seen.depth[kWidth * (kHeight / 2) + kWidth / 2], {0, 1, 0}, false);
    const LightPair light =
        makeLight(GN_LIGHT_TYPE_POINT, middle.receiver + glm::dvec3(0, 1e-5, 0), {0, -1, 0}, 0.0, 0.0);
    ShadowRay ray;
    REQUIRE(Receivers(seen.view, light.view, seen.depth, seen.normalBytes()).at(kWidth / 2, kHeight / 2, ray) ==
            Asked::ray);
    CHECK(ray.tfar < 0.0f);
}

TEST_CASE("halves become the floats they stand for")
{
    CHECK(fromHalf(0x0000) == 0.0f);
    CHECK(std::signbit(fromHalf(0x8000)));
    CHECK(fromHalf(0x3c00) == 1.0f);
    CHECK(fromHalf(0xbc00) == -1.0f);
    CHECK(fromHalf(0x3555) == doctest::Approx(1.0 / 3.0).epsilon(1e-3));
    CHECK(fromHalf(0x7bff) == 65504.0f);
    CHECK(fromHalf(0x0001) == 0x1p-24f);
    CHECK(fromHalf(0x03ff) == 1023.0f * 0x1p-24f);
    CHECK(fromHalf(0x0400) == 0x1p-14f);
    CHECK(std::isinf(fromHalf(0x7c00)));
    CHECK(fromHalf(0xfc00) < 0.0f);
    CHECK(std::isnan(fromHalf(0x7e01)));
}

TEST_CASE("half normals lead to the same rays as full ones where they are the same numbers")
{
    CameraView view;
    view.constants = {};
    view.constants.rayCornerWs = {0, -1, 0, 0}; // looking down at a floor
    view.constants.rayDxWs = {0.01f, 0, 0, 0};
    view.constants.rayDyWs = {0, 0, 0.01f, 0};
    view.constants.depthScale = 0.1f;
    view.constants.depthMul = 1.0f;
    view.constants.offsetFactor = 1.0f;
    view.constants.pixelSize = 0.01f;
    view.extent = {1, 1};
    const float depth[] = {0.05f};
    const std::uint16_t half[] = {0x0000, 0x3c00, 0x0000, 0x0000};
    const float full[] = {0.0f, 1.0f, 0.0f, 0.0f};
    const LightPair light = makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.3, -1.0, 0.1}, 0.0, 0.0);
    ShadowRay fromHalves{}, fromFull{};
    view.normalFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
    REQUIRE(Receivers(view, light.view, depth, std::as_bytes(std::span(half))).at(0, 0, fromHalves) == Asked::ray);
    view.normalFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
    REQUIRE(Receivers(view, light.view, depth, std::as_bytes(std::span(full))).at(0, 0, fromFull) == Asked::ray);
    CHECK(fromHalves.origin == fromFull.origin);
    CHECK(fromFull.origin.y > -2.0f); // moved towards the light
    CHECK(fromFull.origin.y < -2.0f + 1e-3f);
    CHECK(std::isinf(fromFull.tfar));
}
