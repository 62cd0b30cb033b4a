// Where shaders look into maps, against the matrices casters are drawn with and against plain geometry in double.
#include <doctest/doctest.h>

#include "algorithms/shared/cube_faces.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "maps_fixture.hpp"
#include "shaders/shared/cube.h"

using namespace gnomon;
using namespace gnomon::test;
using doctest::Approx;

namespace {

const Aabb kScene{{-8.0f, -1.0f, -8.0f}, {8.0f, 5.0f, 8.0f}};

glm::dvec3 ndc(const glm::mat4& clipFromWorld, glm::dvec3 p)
{
    const glm::dvec4 clip = glm::dmat4(clipFromWorld) * glm::dvec4(p, 1.0);
    return glm::dvec3(clip) / clip.w;
}

/// Where the ray of a map's texel meets a plane, as depth in the map; brute force on the inverse matrix.
double depthOfPlane(const LightFit& fit, glm::dvec2 texel, double side, glm::dvec3 point, glm::dvec3 normal)
{
    const glm::dmat4 worldFromClip = glm::inverse(glm::dmat4(fit.clipFromWorld));
    auto at = [&](double depth) {
        const glm::dvec4 p = worldFromClip * glm::dvec4(2.0 * texel / side - 1.0, depth, 1.0);
        return glm::dvec3(p) / p.w;
    };
    const glm::dvec3 a = at(0.0), b = at(0.5);
    const double t = glm::dot(normal, point - a) / glm::dot(normal, b - a);
    return ndc(fit.clipFromWorld, a + t * (b - a)).z;
}

struct Look {
    CameraView view;
    LightView light{};
    LightCasters casters;
    LightFit fit;
    gpu::MapConstants constants;
    Look(const CameraView& camera, const LightView& lamp, const LightFit& lightFit, std::uint32_t side)
        : view(camera), light(lamp), fit(lightFit)
    {
        ShadowTask task;
        task.view = &view;
        task.light = &light;
        task.casters = &casters;
        constants = mapConstants(task, side, 1);
        addProjection(constants, fit, task);
    }
};

void checkLook(const Look& look, Random& random)
{
    const gpu::MapLookup& map = look.constants.map;
    for (int i = 0; i < 200; ++i) {
        const glm::vec2 pixel(random.in(0.0f, 640.0f), random.in(0.0f, 480.0f));
        const float w = random.in(1.0f, 12.0f);
        const glm::vec3 ray = gpu::viewRayWs(look.constants.view, pixel);
        const glm::vec3 receiver = look.view.eye + w * ray;
        const glm::vec4 clip = map.clipOfEye + w * (map.clipFromRay * glm::vec4(ray, 0.0f));
        if (!(clip.w > 0.5f)) continue; // behind the light
        const glm::dvec3 expected = ndc(look.fit.clipFromWorld, glm::dvec3(receiver));
        // Within 1/256 texel of 1024, to which rasterisers snap.
        CHECK(clip.x / clip.w == Approx((expected.x + 1.0) * 0.5 * map.side).epsilon(4e-6).scale(map.side));
        CHECK(clip.y / clip.w == Approx((expected.y + 1.0) * 0.5 * map.side).epsilon(4e-6).scale(map.side));
        CHECK(clip.z / clip.w == Approx(expected.z).epsilon(1e-4));

        // A plane through the receiver that faces the light, up to 80 degrees.
        const glm::vec3 toLight = gpu::towardsLightWs(look.light.constants, receiver);
        const glm::vec3 normal = glm::normalize(toLight + random.in(0.0f, 5.0f) * random.unit());
        if (glm::dot(normal, toLight) < 0.17f) continue;
        const glm::vec3 axis(map.axisWs), away = receiver - look.light.position();
        const float facing = glm::dot(normal, away * map.positional + axis);
        const glm::vec2 perTexel(glm::dot(normal, glm::vec3(map.texelDx)), glm::dot(normal, glm::vec3(map.texelDy)));
        const gpu::PlanarDepth plane = gpu::planarDepth(map, clip.z / clip.w, 1.0f / clip.w, facing, 0.0f, perTexel);
        const glm::vec2 at = glm::vec2(clip) / clip.w, texel = glm::floor(at) + 0.5f;
        const double truth =
            depthOfPlane(look.fit, glm::dvec2(texel), map.side, glm::dvec3(receiver), glm::dvec3(normal));
        CHECK(plane.at + glm::dot(plane.perTexel, texel - at) == Approx(truth).epsilon(1e-4));

        const gpu::PlanarDepth nearer = gpu::planarDepth(map, clip.z / clip.w, 1.0f / clip.w, facing, 0.01f, perTexel);
        const double moved = depthOfPlane(look.fit, glm::dvec2(at), map.side,
                                          glm::dvec3(receiver) + 0.01 * glm::dvec3(normal), glm::dvec3(normal));
        CHECK(nearer.at == Approx(moved).epsilon(1e-4));
    }
}

} // namespace

TEST_CASE("a receiver and its plane are found in a spot light's map where its matrix puts them")
{
    Random random;
    for (int i = 0; i < 20; ++i) {
        const CameraView view = camera(random.vec(-6.0f, 6.0f), random.unit(), 0.4f, 640, 480);
        const LightView lamp =
            light(GN_LIGHT_TYPE_SPOT, random.vec(8.0f, 12.0f), -glm::normalize(random.vec(0.2f, 1.0f)), 60.0f);
        checkLook(Look(view, lamp, fitSpot(lamp, kScene), 1024), random);
    }
}

TEST_CASE("a receiver and its plane are found in a directional light's map where its matrix puts them")
{
    Random random;
    for (int i = 0; i < 20; ++i) {
        const CameraView view = camera(random.vec(-6.0f, 6.0f), random.unit(), 0.4f, 640, 480);
        const LightView sun = light(GN_LIGHT_TYPE_DIRECTIONAL, {}, random.unit(), kUnlimitedRange);
        checkLook(Look(view, sun, fitDirectional(sun, kScene), 1024), random);
    }
}

TEST_CASE("depths about the light keep their precision half a kilometre from the origin")
{
    const glm::vec3 far(500.0f, 20.0f, 450.0f);
    const LightView lamp = light(GN_LIGHT_TYPE_SPOT, far, {0.0f, -1.0f, 0.0f}, 30.0f);
    const Aabb around{far - glm::vec3(8.0f, 20.0f, 8.0f), far + glm::vec3(8.0f, -0.05f, 8.0f)};
    const LightFit fit = fitSpot(lamp, around);
    const MapProjection projection = mapProjection(fit, lamp);
    for (float t = 0.25f; t < 20.0f; t *= 2.0f) {
        const glm::vec4 clip = projection.clipFromZero * glm::vec4(0.0f, -t, 0.0f, 1.0f);
        const float found = projection.depthScale / (clip.z / clip.w - projection.depthConstant);
        CHECK(found == Approx(t).epsilon(1e-3)); // a float depth near 1 resolves 2^-24 t^2 / near, 1 mm here
    }
}

TEST_CASE("the near end is raised as far as depths need, and not past what the host draws")
{
    const LightView lamp = light(GN_LIGHT_TYPE_SPOT, {0.0f, 4.0f, 0.0f}, {0.0f, -1.0f, 0.0f}, kUnlimitedRange, 0.78f);
    Caster plain, grass, shade;
    plain.bounds = {{-500.0f, -8.0f, -500.0f}, {500.0f, 4.0f, 500.0f}};
    grass.bounds = {{-1.0f, 0.0f, -1.0f}, {1.0f, 1.0f, 1.0f}};
    grass.hostDrawn = true;
    shade.bounds = {{-0.01f, 3.9994f, -0.01f}, {0.01f, 3.9995f, 0.01f}};
    FrameArena arena;
    const auto nearOf = [&](std::vector<const Caster*> pointers, std::uint32_t resolution,
                            Clamped clamped = Clamped::own) {
        LightCasters casters;
        casters.statics = casters.all = pointers;
        ShadowTask task;
        task.light = &lamp;
        task.casters = &casters;
        const LightFit& fit = *fitDepthMap(clamped, task, resolution, arena);
        CHECK(touches(shade.bounds, fit.volume) == (clamped != Clamped::none));
        CHECK(ndc(fit.clipFromWorld, {0.0, 4.0 - static_cast<double>(fit.nearWs), 0.0}).z == Approx(0.0).epsilon(1e-4));
        return fit.nearWs;
    };
    // An eighth of a texel at 12 m is what four units in the last place span there.
    for (const std::uint32_t resolution : {512u, 1024u, 2048u}) {
        const float texel = 12.0f * 2.0f * std::tan(0.78f) / static_cast<float>(resolution);
        CHECK(nearOf({&plain}, resolution) == Approx(12.0f * 12.0f * 0x1p-22f / (texel / 8.0f)).epsilon(0.03));
    }
    CHECK(nearOf({&plain}, 65536) == Approx(12.0f / 128.0f).epsilon(0.01));
    CHECK(nearOf({&plain}, 1024, Clamped::none) == Approx(1.2e-3f).epsilon(0.01));

    const float free = nearOf({&plain}, 1024);     // 1.2 cm
    CHECK(nearOf({&plain, &grass}, 1024) == free); // 3 m
    for (const float gap : {0.011f, 0.005f, 0.002f}) {
        grass.bounds.upper.y = 4.0f - gap;
        const float near = nearOf({&plain, &grass}, 1024);
        CHECK(near <= gap);
        CHECK(near > 0.45f * gap);
        CHECK(nearOf({&plain, &grass}, 1024, Clamped::all) == free);
    }
    grass.bounds.upper.y = 4.5f;
    CHECK(nearOf({&plain, &grass}, 1024) == Approx(1.2e-3f).epsilon(0.01));
}

TEST_CASE("the depth of a receiver does not depend on how far from the light the eye is")
{
    const LightView lamp = light(GN_LIGHT_TYPE_SPOT, {3.0f, 4.0f, 5.0f}, {0.0f, -1.0f, 0.0f}, 30.0f);
    const Aabb around{{-8.0f, -20.0f, -8.0f}, {8.0f, 3.99f, 8.0f}};
    Random random;
    for (int i = 0; i < 200; ++i) {
        const CameraView view = camera(lamp.position() + 190.0f * random.unit(), random.unit(), 0.4f, 640, 480);
        const Look look(view, lamp, fitSpot(lamp, around), 1024);
        const glm::vec3 ray = glm::normalize(lamp.position() + random.in(1.0f, 4.0f) * lamp.direction() - view.eye);
        const float w = random.in(180.0f, 200.0f);
        const gpu::MapLookup& map = look.constants.map;
        const glm::vec4 clip = map.clipOfEye + w * (map.clipFromRay * glm::vec4(ray, 0.0f));
        if (!(clip.w > 0.5f)) continue;
        // What clip w stands for, to three units in the last place.
        const double truth = 1.0 - static_cast<double>(look.fit.nearWs) / static_cast<double>(clip.w);
        CHECK(std::fabs(static_cast<double>(gpu::mapDepth(map, clip)) - truth) <= 3.0 * 0x1p-24);
    }
}

TEST_CASE("the shader's cube faces are those the casters are drawn into, receivers clear of the border")
{
    Random random;
    constexpr std::uint32_t kSide = 256;
    for (int i = 0; i < 2000; ++i) {
        const LightView lamp = light(GN_LIGHT_TYPE_POINT, random.vec(-3.0f, 3.0f), {0, -1, 0}, 40.0f);
        const glm::vec3 fromLight = random.in(0.5f, 20.0f) * random.unit();
        const std::uint32_t face = gpu::cubeFaceOf(fromLight);
        const glm::vec3 local = gpu::inCubeFace(face, fromLight);
        const LightFit fit = fitCubeFace(lamp, kScene, face, kSide, float{kMapBorderTexels});
        const glm::dvec3 expected = ndc(fit.clipFromWorld, glm::dvec3(lamp.position()) + glm::dvec3(fromLight));
        const float slope = 0.5f * fit.texelAtOne;
        CHECK(local.z > 0.0f);
        CHECK(local.x / (local.z * slope) == Approx(expected.x).epsilon(1e-4));
        CHECK(local.y / (local.z * slope) == Approx(expected.y).epsilon(1e-4));
        const float inner = 1.0f - 2.0f * float{kMapBorderTexels} / kSide;
        CHECK(std::fabs(expected.x) <= inner + 1e-5f);
        CHECK(std::fabs(expected.y) <= inner + 1e-5f);
    }
}

namespace {

/// Without a perspective: its picture begins `right` and `down` of the eye and is 400 m by 300 m.
CameraView orthographic(glm::vec3 eye, float right, float down)
{
    CameraView view = camera(eye, {0.0f, 0.0f, -1.0f}, 0.5f, 640, 480);
    gpu::ViewConstants& c = view.constants;
    c.rayDxWs = {400.0f / 640.0f, 0.0f, 0.0f, 0.0f};
    c.rayDyWs = {0.0f, -300.0f / 480.0f, 0.0f, 0.0f};
    c.rayCornerWs = {right, -down, -1.0f, 1.0f};
    c.rayDepthWs = {0.0f, 0.0f, -50.0f, 50.0f};
    c.depthScale = c.depthAdd = 1.0f;
    c.depthMul = 0.0f;
    c.skyDepth = 1.0f;
    c.offsetFactor = 3.0f;
    c.pixelSize = 400.0f / 640.0f;
    view.convention = GN_DEPTH_STANDARD;
    return view;
}

/// The frustum of one eye of a headset: its picture lies beside the middle, by these shares of its size.
CameraView headset(glm::vec3 eye, float right, float down)
{
    CameraView view = camera(eye, glm::normalize(glm::vec3(1.0f, -0.2f, 0.3f)), 0.8f, 640, 480);
    view.constants.rayCornerWs += right * 640.0f * view.constants.rayDxWs + down * 480.0f * view.constants.rayDyWs;
    return view;
}

void checkOffset(const CameraView& view, const LightView& lamp, Random& random)
{
    LightCasters casters;
    ShadowTask task;
    task.view = &view;
    task.light = &lamp;
    task.casters = &casters;
    const gpu::ViewConstants& c = view.constants;
    const glm::vec4 offset = mapConstants(task, 1024, 1).map.offset;
    int smaller = 0;
    for (int i = 0; i < 2000; ++i) {
        const VkRect2D& area = view.area;
        const glm::vec2 pixel(
            static_cast<float>(area.offset.x) + random.in(0, 1) * static_cast<float>(area.extent.width),
            static_cast<float>(area.offset.y) + random.in(0, 1) * static_cast<float>(area.extent.height));
        const float depth = gpu::isOrthographic(c) ? random.in(0.0f, 1.0f) : 0.1f / random.in(0.2f, 400.0f);
        const glm::vec3 ray = gpu::receiverRayWs(c, gpu::viewRayWs(c, pixel), depth);
        const float w = gpu::linearDepth(c, depth);
        const glm::vec3 receiver = view.eye + w * ray;
        const float exact = gpu::receiverOffset(c, lamp.constants, depth, ray, receiver, random.unit());
        smaller += offset.x + w * (offset.y + w * offset.z) < exact;
    }
    CHECK(smaller == 0);
}

} // namespace

TEST_CASE("maps offset receivers by as much as rays do, wherever in the picture the middle of the view is")
{
    Random random;
    const LightView sun = light(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.0f, -1.0f, 0.0f}, kUnlimitedRange);
    const LightView lamp = light(GN_LIGHT_TYPE_SPOT, {3.0f, 4.0f, -5.0f}, {0.0f, -1.0f, 0.0f}, 50.0f);
    for (const LightView* each : {&sun, &lamp})
        for (const float right : {-1.0f, -0.5f, 0.0f})
            for (const float down : {-1.0f, -0.5f, 0.0f}) {
                CAPTURE(right);
                CAPTURE(down);
                checkOffset(orthographic({}, 400.0f * right, 300.0f * down), *each, random);
                checkOffset(headset({}, 0.5f + right, 0.5f + down), *each, random);
                CameraView part = headset({1.0f, 2.0f, 3.0f}, 0.5f + right, 0.5f + down);
                part.area = {{600, 440}, {40, 40}};
                checkOffset(part, *each, random);
            }
}
