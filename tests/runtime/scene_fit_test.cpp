// What a map covers: fits against the points they have to hold.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/scene/light_fit.hpp"

using namespace gnomon;

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

struct Random {
    std::mt19937 engine{5};
    float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    glm::vec3 point(float size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
    glm::vec3 direction() { return glm::normalize(point(1.0f) + glm::vec3(1e-3f)); }
    glm::vec3 inside(const Aabb& box)
    {
        return {in(box.lower.x, box.upper.x), in(box.lower.y, box.upper.y), in(box.lower.z, box.upper.z)};
    }
    Aabb box(float spread)
    {
        const glm::vec3 center = point(spread), half = glm::abs(point(spread));
        return {center - half, center + half};
    }
};

LightView lightOf(GnLightType type, glm::vec3 position, glm::vec3 direction, float range, float cone = kPi / 4)
{
    LightView light{};
    light.type = type;
    light.constants.positionWs = glm::vec4(position, 1.0f);
    light.constants.directionWs = glm::vec4(direction, -2.0f);
    light.constants.range = range;
    light.coneAngle = cone;
    return light;
}

glm::dvec4 clipOf(const LightFit& fit, glm::vec3 point)
{
    return glm::dmat4(fit.clipFromWorld) * glm::dvec4(point, 1.0);
}

/// Smallest distance to a side of clip space, in clip units relative to w; negative outside.
double clipMargin(const LightFit& fit, glm::dvec4 clip)
{
    const double w = clip.w;
    const bool perspective =
        fit.clipFromWorld[0].w != 0.0f || fit.clipFromWorld[1].w != 0.0f || fit.clipFromWorld[2].w != 0.0f;
    const double farSide = perspective ? double{fit.farWs} - w : w - clip.z; // a perspective has no far end of its own
    return std::min({w + clip.x, w - clip.x, w + clip.y, w - clip.y, clip.z, farSide}) / std::max(std::abs(w), 1e-9);
}

/// Smallest distance to a plane, metres; negative outside.
double planeMargin(const LightFit& fit, glm::vec3 point)
{
    double least = 1e30;
    for (const Plane& plane : fit.volume)
        least = std::min(least, glm::dot(glm::dvec3(plane.normal), glm::dvec3(point)) + plane.distance);
    return least;
}

/// Inside all planes if and only if inside clip space, but for points within rounding of a side.
/// @return how many points were inside.
int checkVolume(const LightFit& fit, Random& random, float spread)
{
    int inside = 0;
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 point = random.point(spread);
        const double clip = clipMargin(fit, clipOf(fit, point)), planes = planeMargin(fit, point);
        if (std::abs(planes) < 1e-3 || std::abs(clip) < 1e-5) continue;
        REQUIRE((clip > 0.0) == (planes > 0.0));
        inside += clip > 0.0;
    }
    for (const Plane& plane : fit.volume)
        CHECK(glm::length(plane.normal) == doctest::Approx(1.0f));
    return inside;
}

bool mirrors(const LightFit& fit)
{
    // Columns of the upper 3x3 of a projection seen as (right, down, forward): for perspective the third row is w.
    const glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clipFromWorld));
    const bool perspective = glm::length(glm::dvec3(rows[3])) > 0.5;
    const glm::dvec3 forward = glm::dvec3(perspective ? rows[3] : rows[2]);
    return glm::dot(glm::cross(glm::dvec3(rows[0]), glm::dvec3(rows[1])), forward) < 0.0;
}

} // namespace

TEST_CASE("a spot fit holds every point of the cone between near and range, and its planes are the clip volume")
{
    Random random;
    int inside = 0;
    for (int i = 0; i < 200; ++i) {
        const float cone = random.in(0.05f, kPi / 2 - 0.02f), range = random.in(1.0f, 30.0f);
        const LightView light = lightOf(GN_LIGHT_TYPE_SPOT, random.point(5.0f), random.direction(), range, cone);
        const Aabb scene = random.box(10.0f);
        const LightFit fit = fitSpot(light, scene);
        CHECK(fit.farWs == doctest::Approx(range));
        CHECK(fit.nearWs > 0.0f);
        CHECK(fit.nearWs < fit.farWs);
        CHECK(fit.texelAtOne > 2.0f * std::tan(cone));
        CHECK(fit.texelAtOne < 2.003f * std::tan(cone)); // wider by what float cosines may be off
        CHECK_FALSE(mirrors(fit));
        for (int k = 0; k < 200; ++k) {
            const glm::vec3 offset = random.direction() * range * std::sqrt(random.in(0.0f, 1.0f));
            const float along = glm::dot(offset, light.direction());
            if (along < std::cos(cone) * glm::length(offset) || along <= fit.nearWs) continue;
            REQUIRE(clipMargin(fit, clipOf(fit, light.position() + offset)) > -1e-4);
        }
        inside += checkVolume(fit, random, 20.0f);
    }
    CHECK(inside > 1000);
}

TEST_CASE("depth is 0 at near and goes to 1 as near over the distance goes to 0")
{
    const LightView light = lightOf(GN_LIGHT_TYPE_SPOT, {1, 2, 3}, {0, 0, -1}, 10.0f);
    const LightFit fit = fitSpot(light, {{0, 1, -4}, {2, 3, -2}});
    const auto depthAt = [&](float distance) {
        const glm::dvec4 clip = clipOf(fit, light.position() + distance * light.direction());
        return clip.z / clip.w;
    };
    CHECK(fit.nearWs == doctest::Approx(5.0f).epsilon(0.01));
    CHECK(depthAt(fit.nearWs) == doctest::Approx(0.0).epsilon(1e-4));
    CHECK(depthAt(2.0f * fit.nearWs) == doctest::Approx(0.5));
    CHECK(depthAt(1e6f * fit.nearWs) == doctest::Approx(1.0).epsilon(2e-6));
}

TEST_CASE("no caster is nearer than near, unless it comes closer to the light than 1/10000 of what is there")
{
    Random random;
    for (int i = 0; i < 500; ++i) {
        const Aabb scene = random.box(10.0f);
        const glm::vec3 position = random.point(15.0f);
        const LightView spot = lightOf(GN_LIGHT_TYPE_SPOT, position, random.direction(), kUnlimitedRange, 0.6f);
        const LightView point = lightOf(GN_LIGHT_TYPE_POINT, position, {}, kUnlimitedRange);
        const LightFit spotFit = fitSpot(spot, scene), faceFit = fitCubeFace(point, scene, 2, 512, 4.0f);
        const float smallest = 1.01e-4f * spotFit.farWs;
        for (int k = 0; k < 50; ++k) {
            const glm::vec3 offset = random.inside(scene) - position;
            const float along = glm::dot(offset, spot.direction());
            if (along > 0.0f) REQUIRE((along >= spotFit.nearWs || spotFit.nearWs <= smallest));
            const glm::vec3 size = glm::abs(offset);
            const float major = std::max({size.x, size.y, size.z});
            REQUIRE((major >= faceFit.nearWs || faceFit.nearWs <= smallest));
            REQUIRE(along <= spotFit.farWs);
            REQUIRE(major <= faceFit.farWs);
            REQUIRE(glm::length(offset) <= casterReach(point, scene));
        }
    }
}

TEST_CASE("every receiver that shaders find in a cone lies in its map, however narrow, and clear of the border")
{
    Random random;
    constexpr std::uint32_t kSide = 512;
    constexpr float kBorder = 4.0f;
    int rim = 0;
    for (int i = 0; i < 4000; ++i) {
        const float cone = std::exp(random.in(std::log(5e-4f), std::log(kPi / 2 - 0.02f)));
        LightView light = lightOf(GN_LIGHT_TYPE_SPOT, {}, random.direction(), kUnlimitedRange, cone);
        light.constants.directionWs.w = std::cos(cone);
        const LightFit fit = fitSpot(light, {{-9, -9, -9}, {9, 9, 9}}, kSide, kBorder);
        const float cosine = light.constants.directionWs.w;
        const glm::vec4 shaderCone(light.direction(), cosine * std::fabs(cosine));
        for (int k = 0; k < 50; ++k) {
            // Just about the rim.
            const glm::vec3 across = glm::normalize(glm::cross(light.direction(), random.direction()));
            const float slope =
                std::tan(cone) * (1.0f + 1e-3f * random.in(-1.0f, 1.0f) + random.in(0.0f, 1e-3f) / cone);
            const glm::vec3 fromLight = random.in(0.1f, 30.0f) * (light.direction() + slope * across);
            if (!gpu::reaches(fromLight, shaderCone, INFINITY)) continue;
            const glm::dvec4 clip = glm::dmat4(fit.clipFromWorld) * glm::dvec4(fromLight, 1.0);
            const double outermost = std::max(std::abs(clip.x), std::abs(clip.y)) / clip.w;
            REQUIRE(outermost <= 1.0 - 2.0 * kBorder / kSide + 1e-4);
            rim += outermost > 0.95 - 2.0 * kBorder / kSide;
        }
    }
    CHECK(rim > 1000);
}

TEST_CASE("a lamp over a wide plain has its far end where the plain is, seen along its axis")
{
    const Aabb plain{{-500, 0, -500}, {500, 3.8f, 500}};
    const LightFit down = fitSpot(lightOf(GN_LIGHT_TYPE_SPOT, {0, 4, 0}, {0, -1, 0}, kUnlimitedRange, 0.7f), plain);
    CHECK(down.farWs == doctest::Approx(4.0f).epsilon(0.01));
    CHECK(down.endWs == down.farWs);
    const LightFit ranged = fitSpot(lightOf(GN_LIGHT_TYPE_SPOT, {0, 4, 0}, {0, -1, 0}, 30.0f, 0.7f), plain);
    CHECK(ranged.farWs == 30.0f);
    CHECK(ranged.endWs == down.endWs);
    const LightView bulb = lightOf(GN_LIGHT_TYPE_POINT, {0, 4, 0}, {}, 1e6f);
    CHECK(fitCubeFace(bulb, plain, 0, 512, 4.0f).endWs == doctest::Approx(500.0f).epsilon(0.01));
    CHECK(casterReach(bulb, plain) == doctest::Approx(707.0f).epsilon(0.01));
    CHECK(casterReach(lightOf(GN_LIGHT_TYPE_POINT, {0, 4, 0}, {}, 20.0f), plain) == 20.0f);
}

TEST_CASE("a range far larger than the scene does not push near into the casters")
{
    const LightView light = lightOf(GN_LIGHT_TYPE_SPOT, {0, 0, 0}, {0, -1, 0}, 1e6f);
    const LightFit fit = fitSpot(light, {{-1, -6, -1}, {1, 0.5f, 1}});
    CHECK(fit.farWs == 1e6f);
    CHECK(fit.nearWs < 1e-3f);
    const LightFit empty = fitSpot(light, Aabb{});
    CHECK(empty.nearWs > 0.0f);
    CHECK(empty.nearWs < empty.farWs);
}

TEST_CASE("a directional fit holds the scene, little more, and its planes are the clip volume")
{
    Random random;
    int inside = 0;
    for (int i = 0; i < 300; ++i) {
        const Aabb scene = random.box(10.0f);
        const glm::vec3 direction =
            i < 6 ? glm::vec3((i % 3) == 0, (i % 3) == 1, (i % 3) == 2) * (i < 3 ? 1.0f : -1.0f) : random.direction();
        const LightFit fit = fitDirectional(lightOf(GN_LIGHT_TYPE_DIRECTIONAL, {}, direction, kUnlimitedRange), scene);
        CHECK_FALSE(mirrors(fit));
        glm::dvec3 lower(1e9), upper(-1e9);
        for (int k = 0; k < 8; ++k) {
            const glm::vec3 corner{k & 1 ? scene.upper.x : scene.lower.x, k & 2 ? scene.upper.y : scene.lower.y,
                                   k & 4 ? scene.upper.z : scene.lower.z};
            const glm::dvec4 clip = clipOf(fit, corner);
            REQUIRE(clip.w == doctest::Approx(1.0));
            REQUIRE(clipMargin(fit, clip) >= 0.0);
            lower = glm::min(lower, glm::dvec3(clip));
            upper = glm::max(upper, glm::dvec3(clip));
            const float along = glm::dot(corner, direction);
            REQUIRE(along >= fit.nearWs);
            REQUIRE(along <= fit.farWs);
            REQUIRE((clip.z - (along - fit.nearWs) / (fit.farWs - fit.nearWs)) == doctest::Approx(0.0).epsilon(1e-4));
        }
        REQUIRE(upper.x - lower.x > 1.99);
        REQUIRE(upper.y - lower.y > 1.99);
        REQUIRE(upper.z - lower.z > 0.995);
        inside += checkVolume(fit, random, 12.0f);
    }
    CHECK(inside > 1000);
}

TEST_CASE("a directional fit of nothing, of a point and of a flat scene is still a projection")
{
    for (const Aabb& scene : {Aabb{}, Aabb{glm::vec3(3), glm::vec3(3)}, Aabb{{-5, 1, -5}, {5, 1, 5}}}) {
        const LightFit fit = fitDirectional(lightOf(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0, -1, 0}, kUnlimitedRange), scene);
        CHECK(std::isfinite(glm::determinant(fit.clipFromWorld)));
        CHECK(std::abs(glm::determinant(glm::dmat4(fit.clipFromWorld))) > 0.0);
        CHECK(fit.farWs > fit.nearWs);
        CHECK(clipMargin(fit, clipOf(fit, scene.center())) > 0.0);
    }
}

TEST_CASE("six cube faces hold every direction, each its own with the border around it")
{
    Random random;
    const std::uint32_t resolution = 256;
    const float border = 4.0f;
    const LightView light = lightOf(GN_LIGHT_TYPE_POINT, {3, -2, 1}, {}, 20.0f);
    const Aabb scene{{-8, -8, -8}, {8, 8, 8}};
    std::array<LightFit, 6> faces;
    for (std::uint32_t face = 0; face < 6; ++face) {
        faces[face] = fitCubeFace(light, scene, face, resolution, border);
        CHECK_FALSE(mirrors(faces[face]));
        CHECK(faces[face].nearWs == faces[0].nearWs);
        CHECK(faces[face].farWs == 20.0f);
        CHECK(checkVolume(faces[face], random, 20.0f) > 5);
    }
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 direction = random.direction(), size = glm::abs(direction);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::uint32_t face = static_cast<std::uint32_t>(2 * axis + (direction[axis] < 0.0f));
        const glm::dvec4 clip = clipOf(faces[face], light.position() + 10.0f * direction);
        REQUIRE(clipMargin(faces[face], clip) > 0.0);
        // Texel coordinate stays `border` texels away from the edge of the map.
        for (const double x : {clip.x / clip.w, clip.y / clip.w}) {
            const double texel = (0.5 + 0.5 * x) * resolution;
            REQUIRE(texel >= border - 1e-3);
            REQUIRE(texel <= resolution - border + 1e-3);
        }
    }
    const glm::dvec4 edge = clipOf(faces[0], light.position() + glm::vec3(5, 5, 0));
    CHECK(std::max(std::abs(edge.x), std::abs(edge.y)) / edge.w == doctest::Approx(1.0 - 2.0 * border / resolution));
    CHECK(faces[0].texelAtOne == doctest::Approx(2.0 / (1.0 - 2.0 * border / resolution)));
}

TEST_CASE("scene bounds hold all casters and stay the same while one moves inside")
{
    Caster room, walker;
    room.bounds = {{-10, 0, -10}, {10, 5, 10}};
    walker.bounds = {{-1, 0, -1}, {1, 2, 1}};
    const Caster* all[] = {&room, &walker};
    LightCasters casters;
    casters.all = all;
    casters.statics = casters.all.first(1);
    casters.dynamics = casters.all.subspan(1);
    const Aabb still = sceneBounds(casters);
    CHECK(still.lower == room.bounds.lower);
    CHECK(still.upper == room.bounds.upper);

    Random random;
    int changes = 0;
    Aabb last = still;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 shift(0.05f * static_cast<float>(i), 0, 0); // walks out of the room, 1 m past the wall
        walker.bounds = {glm::vec3(-1, 0, -1) + shift, glm::vec3(1, 2, 1) + shift};
        const Aabb bounds = sceneBounds(casters);
        REQUIRE(glm::all(glm::lessThanEqual(bounds.lower, glm::min(room.bounds.lower, walker.bounds.lower))));
        REQUIRE(glm::all(glm::greaterThanEqual(bounds.upper, glm::max(room.bounds.upper, walker.bounds.upper))));
        REQUIRE(bounds.upper.x <= 10.0f + 21.0f / 8.0f);
        changes += bounds.lower != last.lower || bounds.upper != last.upper;
        last = bounds;
    }
    CHECK(changes == 1);
    CHECK(last.upper.y == 5.0f);

    casters.all = casters.statics = {};
    casters.dynamics = {};
    CHECK(sceneBounds(casters).upper == glm::vec3(0.0f));
}
