// What a view sees of a light's map, and the maps of that alone, for views and lights at random; no device.
#include <doctest/doctest.h>

#include <glm/matrix.hpp>

#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/trapezoid.hpp"
#include "algorithms/warped/warped_map.hpp"
#include "maps_fixture.hpp"
#include "shaders/maps/desired_view.h"

using namespace gnomon;
using namespace gnomon::test;
using doctest::Approx;

namespace {

constexpr std::uint32_t kSide = 512;

/// A task over casters that stand about in a land.
struct Land {
    CameraView view;
    LightView lamp;
    std::vector<Caster> all;
    std::vector<const Caster*> pointers;
    LightCasters casters;
    FrameArena arena;
    LightFit plain;
    SeenPart part;

    Land(Random& random, GnLightType type)
    {
        const glm::vec3 way =
            glm::normalize(glm::vec3(random.in(-1.0f, 1.0f), random.in(-1.0f, -0.2f), random.in(-1.0f, 1.0f)));
        lamp = light(type, glm::vec3(0.0f, 15.0f, 0.0f) - 20.0f * way,
                     type == GN_LIGHT_TYPE_SPOT ? way : glm::normalize(way), kUnlimitedRange, random.in(0.2f, 1.0f));
        view = camera({random.in(-40.0f, 40.0f), random.in(0.5f, 12.0f), random.in(-40.0f, 40.0f)},
                      glm::normalize(random.unit() - glm::vec3(0.0f, 0.2f, 0.0f)), random.in(0.1f, 0.7f), 640, 360);
        all.resize(8);
        for (Caster& caster : all) {
            const glm::vec3 at(random.in(-30.0f, 30.0f), 0.0f, random.in(-30.0f, 30.0f));
            caster.bounds = {at, at + random.vec(0.1f, 6.0f)};
            pointers.push_back(&caster);
        }
        casters.all = casters.statics = pointers;
        const ShadowTask task = this->task();
        plain = *fitDepthMap(Clamped::all, task, kSide, arena);
        part = seenPart(task, plain);
    }
    ShadowTask task() const
    {
        ShadowTask task;
        task.view = &view;
        task.light = &lamp;
        task.casters = &casters;
        return task;
    }
    bool directional() const { return lamp.type == GN_LIGHT_TYPE_DIRECTIONAL; }
    glm::dvec3 seen(Random& random) const
    {
        const glm::vec2 pixel(random.in(0.0f, 640.0f), random.in(0.0f, 360.0f));
        const double depth = 0.1 * std::pow(1000.0, static_cast<double>(random.in(0.0f, 1.0f)));
        return glm::dvec3(view.eye) + depth * glm::dvec3(gpu::viewRayWs(view.constants, pixel));
    }
};

glm::dvec4 clipOf(const LightFit& fit, glm::dvec3 point)
{
    return glm::dmat4(fit.clipFromWorld) * glm::dvec4(point, 1.0);
}

bool inMap(const glm::dvec4& clip, double room = 0.0)
{
    return clip.w > 0.0 && std::max(std::abs(clip.x), std::abs(clip.y)) <= (1.0 + room) * clip.w;
}

/// Whether anything between the light and the point can be in the casters' bounds: brute force, along the ray.
bool mayBeShaded(const Land& land, glm::dvec3 point)
{
    const Aabb box = sceneBounds(land.casters);
    const glm::dvec3 way =
        land.directional() ? -200.0 * glm::dvec3(land.lamp.direction()) : glm::dvec3(land.lamp.position()) - point;
    double from = 0.0, to = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = (static_cast<double>(box.lower[axis]) - point[axis]) / way[axis];
        const double high = (static_cast<double>(box.upper[axis]) - point[axis]) / way[axis];
        from = std::max(from, std::min(low, high));
        to = std::min(to, std::max(low, high));
    }
    return from <= to;
}

Warp someWarp(const Land& land, Random& random)
{
    return {land.part.away, random.in(0.0f, 1.0f) < 0.3f ? 0.0 : static_cast<double>(random.in(0.0f, 20.0f))};
}

const GnLightType kTypes[] = {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT};

} // namespace

TEST_CASE("a trapezoid's corners become the corners of the square, points in it stay in it, 80 % go to what is near")
{
    Random random;
    for (int i = 0; i < 300; ++i) {
        std::vector<glm::dvec2> points(20);
        for (glm::dvec2& p : points)
            p = glm::dvec2(glm::vec2(random.vec(-9.0f, 9.0f)));
        const double angle = random.in(0.0f, 6.28f), focus = random.in(0.02f, 0.79f);
        const Warp warp{{std::cos(angle), std::sin(angle)}, focusStrength(focus)};
        const Trapezoid trapezoid = trapezoidAround(points, warp);
        const auto at = [&](glm::dvec2 p) {
            const glm::dvec3 clip = trapezoid.map * glm::dvec3(p, 1.0);
            REQUIRE(clip.z > 0.0);
            return glm::dvec2(clip) / clip.z;
        };
        const glm::dvec2 square[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        for (std::size_t corner = 0; corner < 4; ++corner)
            CHECK(glm::length(at(trapezoid.corners[corner]) - square[corner]) < 1e-5);
        for (const glm::dvec2 p : points)
            CHECK(std::max(std::abs(at(p).x), std::abs(at(p).y)) < 1.0 + 1e-9);
        const glm::dvec2 near = 0.5 * (trapezoid.corners[0] + trapezoid.corners[1]),
                         far = 0.5 * (trapezoid.corners[2] + trapezoid.corners[3]);
        const double length = glm::dot(far - near, warp.away);
        CHECK(at(near + focus * length * warp.away).y == Approx(0.6)); // 80 % of [-1, 1]
        // Martin and Tan: the sides meet q before the near one.
        const double d = focus * length, x = -0.6;
        const double q = length * d * (1.0 + x) / (length - 2.0 * d - length * x);
        const double ratio = glm::length(trapezoid.corners[2] - trapezoid.corners[3]) /
                             glm::length(trapezoid.corners[1] - trapezoid.corners[0]);
        CHECK(ratio == Approx((q + length) / q));
        CHECK(glm::determinant(trapezoid.map) > 0.0); // nothing is mirrored
    }
    CHECK(focusStrength(0.8) == 0.0);
    CHECK(focusStrength(1.0) == 0.0);
}

TEST_CASE("the smallest rectangle is no larger than any of 3600 turns of one")
{
    Random random;
    for (int i = 0; i < 60; ++i) {
        std::vector<glm::dvec2> points(12);
        for (glm::dvec2& p : points)
            p = glm::dvec2(glm::vec2(random.vec(-5.0f, 5.0f)) * glm::vec2(1.0f, 0.3f));
        const MapPolygon hull = convexHull(points);
        const auto area = [&](glm::dvec2 away) {
            double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
            for (const glm::dvec2 p : points)
                for (int axis = 0; axis < 2; ++axis) {
                    const double at = axis == 0 ? glm::dot(p, away) : glm::dot(p, glm::dvec2(away.y, -away.x));
                    low[axis] = std::min(low[axis], at);
                    high[axis] = std::max(high[axis], at);
                }
            return (high[0] - low[0]) * (high[1] - low[1]);
        };
        const double found = area(smallestRectangle(hull.points()));
        double least = 1e9;
        for (int turn = 0; turn < 3600; ++turn) {
            const double angle = turn * (3.14159265358979 / 3600.0);
            least = std::min(least, area({std::cos(angle), std::sin(angle)}));
        }
        CHECK(found <= least * (1.0 + 1e-9));
        CHECK(found >= 0.99 * least);
    }
}

TEST_CASE("every receiver in view that casters may shade is in the map, with all that may shade it, in order")
{
    Random random;
    for (const GnLightType type : kTypes) {
        int inside = 0, warped = 0;
        for (int i = 0; i < 300; ++i) {
            const Land land(random, type);
            const Warp warps[] = {someWarp(land, random)};
            const LightFit fit = fitWarped(land.plain, land.part, warps, kSide, 4.0f);
            warped += fit.clipFromWorld != land.plain.clipFromWorld;
            for (int j = 0; j < 200; ++j) {
                const glm::dvec3 point = land.seen(random);
                const glm::dvec4 plain = clipOf(land.plain, point);
                // What the plain map covers, before and beyond its casters.
                if (!inMap(plain) || !mayBeShaded(land, point)) continue;
                if (type == GN_LIGHT_TYPE_SPOT && plain.w < 1.01 * static_cast<double>(land.plain.nearWs)) continue;
                ++inside;
                const glm::dvec4 clip = clipOf(fit, point);
                REQUIRE(inMap(clip, 1e-4));
                // A caster nearer to the light is at the same place with a lesser depth, above 0.
                const glm::dvec3 to = type == GN_LIGHT_TYPE_SPOT ? glm::dvec3(land.lamp.position()) - point
                                                                 : -10.0 * glm::dvec3(land.lamp.direction());
                const glm::dvec3 caster = point + static_cast<double>(random.in(0.05f, 0.9f)) * to;
                const glm::dvec4 above = clipOf(fit, caster);
                REQUIRE(above.w > 0.0);
                CHECK(glm::length(glm::dvec2(above) / above.w - glm::dvec2(clip) / clip.w) < 2e-4);
                CHECK(above.z / above.w < clip.z / clip.w);
                if (clipOf(land.plain, caster).z > 0.0 && clipOf(land.plain, caster).z < clipOf(land.plain, caster).w) {
                    CHECK(above.z / above.w > -1e-6);
                    CHECK(above.z / above.w < 1.0 + 1e-6);
                }
                CHECK(touches(Aabb{glm::vec3(caster), glm::vec3(caster)}, fit.volume) ==
                      touches(Aabb{glm::vec3(caster), glm::vec3(caster)}, land.plain.volume));
            }
        }
        CHECK(inside > 2000);
        CHECK(warped > 50);
    }
}

TEST_CASE("a crop holds all that is seen with a border around it, is part of the map, and nowhere coarser")
{
    Random random;
    int finer = 0;
    for (int i = 0; i < 20'000; ++i) {
        const float side = std::exp2(random.in(6.0f, 13.0f)), border = random.in(1.0f, 8.0f);
        const float a = random.in(0.0f, 1.0f), b = i % 4 == 0 ? a : random.in(0.0f, 1.0f);
        const float low = std::min(a, b), high = std::max(a, b);
        const glm::vec2 crop = gpu::cropAxis(low, high, side, border);
        const auto at = [&](float texel) { return crop.x * texel + crop.y; };
        REQUIRE(crop.x >= 1.0f);
        const float rounding = 1e-6f * side * crop.x;
        CHECK(at(0.0f) <= rounding); // the map's ends lie at its own or beyond
        CHECK(at(side) >= side - rounding);
        // At the map's end there is no border to be had.
        CHECK(at(low * side) >= std::min(border, crop.x * low * side) - rounding);
        CHECK(at(high * side) <= side - std::min(border, crop.x * (1.0f - high) * side) + rounding);
        if (high - low < 0.5f && side > 256.0f) {
            CHECK(crop.x > 1.5f);
            ++finer;
        }
    }
    CHECK(finer > 1000);
    CHECK(gpu::cropAxis(1.0f, 0.0f, 512.0f, 4.0f) == glm::vec2(1.0f, 0.0f)); // nothing is seen
}

TEST_CASE("a receiver and its plane are found in a warped map where its matrix puts them")
{
    Random random;
    for (const GnLightType type : kTypes) {
        int found = 0;
        for (int i = 0; i < 100; ++i) {
            const Land land(random, type);
            const Warp warps[] = {someWarp(land, random)};
            const LightFit fit = fitWarped(land.plain, land.part, warps, kSide, 4.0f);
            gpu::MapConstants constants = mapConstants(land.task(), kSide, 1);
            addWarpedProjection(constants, fit, land.task());
            const gpu::MapLookup& map = constants.map;
            const glm::dmat4 worldFromClip = glm::inverse(glm::dmat4(fit.clipFromWorld));
            for (int j = 0; j < 40; ++j) {
                const glm::vec2 pixel(random.in(0.0f, 640.0f), random.in(0.0f, 360.0f));
                const glm::vec3 ray = gpu::viewRayWs(land.view.constants, pixel);
                const float w = random.in(2.0f, 30.0f);
                const glm::vec3 receiver = land.view.eye + w * ray;
                const glm::dvec4 truth = clipOf(fit, glm::dvec3(receiver));
                if (!inMap(truth)) continue;
                ++found;
                const glm::vec4 clip = map.clipOfEye + w * (map.clipFromRay * glm::vec4(ray, 0.0f));
                const glm::dvec2 at = 0.5 * kSide * (glm::dvec2(truth) / truth.w + 1.0);
                CHECK(glm::length(glm::dvec2(glm::vec2(clip) / clip.w) - at) < 0.02);

                const glm::vec3 toLight = gpu::towardsLightWs(land.lamp.constants, receiver);
                const glm::vec3 normal = glm::normalize(toLight + random.in(0.0f, 2.0f) * random.unit());
                if (glm::dot(normal, toLight) < 0.3f) continue;
                const float depth = map.positional != 0.0f ? gpu::mapDepth(map, clip) : clip.z / clip.w;
                const float facing =
                    glm::dot(normal, (receiver - land.lamp.position()) * map.positional + glm::vec3(map.axisWs));
                const float plane = glm::dot(normal, w * ray);
                const glm::vec2 perTexel(glm::dot(normal, glm::vec3(map.texelDx)) - map.texelDx.w * plane,
                                         glm::dot(normal, glm::vec3(map.texelDy)) - map.texelDy.w * plane);
                const gpu::PlanarDepth planar = gpu::planarDepth(map, depth, 1.0f / clip.w, facing, 0.0f, perTexel);
                // Where a texel's own ray, by the inverse matrix, meets the plane; within what the look-up allows for.
                const glm::vec2 texel = glm::floor(glm::vec2(clip) / clip.w) + glm::vec2(1.5f, -0.5f);
                const auto onRay = [&](double z) {
                    const glm::dvec4 p =
                        worldFromClip * glm::dvec4(2.0 * glm::dvec2(texel) / double{kSide} - 1.0, z, 1.0);
                    return glm::dvec3(p) / p.w;
                };
                const glm::dvec3 a = onRay(0.0), b = onRay(0.5), n(normal);
                const glm::dvec4 hit =
                    clipOf(fit, a + (b - a) * (glm::dot(n, glm::dvec3(receiver) - a) / glm::dot(n, b - a)));
                const double slack =
                    double{gpu::DEPTH_ROUNDING} +
                    double{gpu::SNAP_TEXELS} * double{std::abs(planar.perTexel.x) + std::abs(planar.perTexel.y)};
                const double z = double{planar.at} + glm::dot(glm::dvec2(planar.perTexel), glm::dvec2(texel) - at);
                CHECK(std::abs(z - hit.z / hit.w) < slack);
            }
        }
        CHECK(found > 300);
    }
}
