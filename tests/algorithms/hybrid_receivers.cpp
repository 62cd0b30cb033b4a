// The CPU's receivers and rays against the brute force: views near and far from the world's zero, both kinds of depth,
// all kinds of light.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/hybrid/receivers.hpp"
#include "runtime/api/context.hpp"
#include "runtime/brute_force.hpp"
#include "runtime/ray_fixture.hpp"

using namespace gnomon;
using test::TracedMesh;

namespace {

constexpr int kWidth = 160, kHeight = 120;

void addBox(std::vector<glm::vec3>& corners, std::vector<std::uint32_t>& indices, const glm::mat4& worldFromBox)
{
    const auto base = static_cast<std::uint32_t>(corners.size());
    for (unsigned i = 0; i < 8; ++i)
        corners.emplace_back(worldFromBox *
                             glm::vec4(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f, 1.0f));
    for (const std::uint32_t v :
         {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
        indices.push_back(base + v);
}

/// Bumpy ground, a wall of one centimetre, tilted boxes, and loose triangles in the air.
TracedMesh makeScene(RayScene& rays)
{
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> indices;
    constexpr std::uint32_t side = 16;
    for (std::uint32_t z = 0; z <= side; ++z) {
        for (std::uint32_t x = 0; x <= side; ++x)
            corners.emplace_back(2.0f * static_cast<float>(x) - 16.0f, 0.3f * std::sin(static_cast<float>(x * z)),
                                 2.0f * static_cast<float>(z) - 16.0f);
    }
    for (std::uint32_t z = 0; z < side; ++z) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = z * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
            indices.insert(indices.end(), {a, c, b, b, c, d});
        }
    }
    const glm::mat4 one(1.0f);
    addBox(corners, indices, glm::scale(glm::translate(one, {-3, 1.5f, 0}), {0.005f, 1.5f, 3.0f}));
    for (int i = 0; i < 4; ++i) {
        const auto f = static_cast<float>(i);
        addBox(corners, indices,
               glm::rotate(glm::translate(one, {3.0f * f - 4.0f, 0.9f, f - 5.0f}), 0.7f * f + 0.2f, {1, 2, 0.5f}));
    }
    std::mt19937 random(11);
    for (const glm::vec3& corner : test::randomTriangles(random, 150, 7.0f, 1.2f)) {
        indices.push_back(static_cast<std::uint32_t>(corners.size()));
        corners.push_back(corner + glm::vec3(0, 9.5f, 0));
    }
    return TracedMesh(rays, std::move(corners), std::move(indices));
}

struct Camera {
    GnDepthConvention convention = GN_DEPTH_REVERSED_INFINITE;
    glm::dvec3 eye{0.0, 5.0, 14.0}; ///< Relative to the scene.
    double place[3]{};              ///< World position of the scene's zero.
    bool normals = true;
};

/// What the host would hand over and what the brute force is told, of the same camera. The frame's origin is the
/// scene's zero, so that both speak of the same coordinates.
struct Seen {
    brute::View truth;
    CameraView view;
    std::vector<float> depth;
    std::vector<glm::vec4> normals;

    std::span<const std::byte> normalBytes() const { return std::as_bytes(std::span<const glm::vec4>(normals)); }
};

Seen look(const Camera& camera, std::span<const brute::Triangle> triangles)
{
    GnViewFrame frame{};
    const glm::mat4 viewFromWorld = glm::lookAt(glm::vec3(camera.eye), glm::vec3(0, 1, 0), glm::vec3(0, 1, 0));
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            frame.viewFromWorld[3 * row + column] = viewFromWorld[column][row];
    }
    constexpr float focal = 1.4f, near = 0.1f, far = 200.0f;
    frame.projection[0] = focal * kHeight / kWidth;
    frame.projection[5] = -focal;
    frame.projection[8] = 0.013f; // jitter
    frame.projection[11] = -1.0f;
    const bool standard = camera.convention == GN_DEPTH_STANDARD;
    frame.projection[10] = standard ? far / (near - far) : 0.0f;
    frame.projection[14] = standard ? far * near / (near - far) : near;
    frame.depthConvention = camera.convention;
    frame.depthFormat = VK_FORMAT_D32_SFLOAT;
    frame.imageExtent = {kWidth, kHeight};
    frame.normalFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
    if (camera.normals) frame.normalImage = reinterpret_cast<VkImage>(std::uintptr_t{1});
    const std::array<double, 3> origin{camera.place[0], camera.place[1], camera.place[2]};
    for (int i = 0; i < 3; ++i)
        frame.eye[i] = camera.eye[i] + camera.place[i];

    Seen seen;
    seen.view = makeCameraView(frame, origin, 0);
    for (int i = 0; i < 3; ++i)
        seen.truth.eye[i] = frame.eye[i] - origin[std::size_t(i)];
    std::copy(std::begin(frame.viewFromWorld), std::end(frame.viewFromWorld), seen.truth.viewFromWorld.begin());
    std::copy(std::begin(frame.projection), std::end(frame.projection), seen.truth.projection.begin());
    seen.truth.width = kWidth;
    seen.truth.height = kHeight;
    seen.truth.convention = camera.convention;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const brute::Surface surface = brute::surfaceAt(seen.truth, triangles, x, y);
            seen.depth.push_back(surface.depth);
            seen.normals.emplace_back(surface.normal, 0.0f);
        }
    }
    return seen;
}

struct LightPair {
    brute::Light truth;
    LightView view;
};

LightPair makeLight(GnLightType type, glm::dvec3 position, glm::dvec3 direction, double range, double cone)
{
    LightPair light;
    light.truth = {type, position, direction, range, cone};
    light.view.type = type;
    light.view.constants.positionWs = glm::vec4(glm::vec3(position), type == GN_LIGHT_TYPE_DIRECTIONAL ? 0.0f : 1.0f);
    light.view.constants.directionWs = glm::vec4(
        glm::vec3(glm::normalize(direction)), type == GN_LIGHT_TYPE_SPOT ? static_cast<float>(std::cos(cone)) : -2.0f);
    light.view.constants.range = range > 0.0 ? static_cast<float>(range) : std::numeric_limits<float>::max();
    light.view.constants.type = static_cast<gpu::uint>(type);
    return light;
}

struct Tally {
    int asked = 0, lit = 0, dark = 0, unreached = 0, grazing = 0, ambiguous = 0;
    int wrong = 0;          ///< Among light-facing, non-grazing, unambiguous pixels.
    int wrongAmbiguous = 0; ///< Among ambiguous ones, not grazing.
    int otherState = 0;     ///< Asked where the truth does not ask, or the opposite.
};

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
                brute::answerAt(seen.truth, light.truth, truth, x, y, seen.depth[pixel], normals ? &normal : nullptr);
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
            rays.occluded({&ray, 1}, 1u, RayCoherence::sparse, {&occluded, 1});
            const bool wrong = (occluded == 0) != answer.lit;
            if (answer.grazing) continue;
            tally.ambiguous += answer.ambiguous;
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
    CHECK(t.asked > 10000);
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
                                                 seen.depth[kWidth * (kHeight / 2) + kWidth / 2], nullptr);
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
