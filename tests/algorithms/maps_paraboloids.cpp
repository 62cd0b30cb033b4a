// What paraboloids show, and where: round trips, cones and skewed halves against closed formulas and brute force.
#include <doctest/doctest.h>

#include "algorithms/shared/paraboloid_fit.hpp"
#include "maps_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;
using doctest::Approx;

namespace {

constexpr std::uint32_t kSide = 1024;
constexpr float kReach = 100.0f;

struct Seen {
    CameraView view;
    LightView lamp;
    LightCasters casters;
    ShadowTask task;
    Seen(const CameraView& camera, const LightView& light) : view(camera), lamp(light)
    {
        task.view = &view;
        task.light = &lamp;
        task.casters = &casters;
    }
    Seen(const Seen&) = delete;
};

LightView lampAt(glm::vec3 position, float range = kUnlimitedRange)
{
    return light(GN_LIGHT_TYPE_POINT, position, {0, -1, 0}, range);
}

glm::vec2 onMap(const gpu::Paraboloid& part, glm::vec3 direction)
{
    return gpu::paraboloidMap(part, gpu::paraboloidDisc(gpu::inParaboloid(part, direction)));
}

/// Solid angle per unit of the map's area, by differences.
float solidAngle(const gpu::Paraboloid& part, glm::vec2 at)
{
    constexpr float kStep = 1e-3f;
    const auto direction = [&](glm::vec2 place) { return gpu::paraboloidDirection(gpu::paraboloidOfMap(part, place)); };
    const glm::vec3 dx = direction(at + glm::vec2(kStep, 0)) - direction(at - glm::vec2(kStep, 0));
    const glm::vec3 dy = direction(at + glm::vec2(0, kStep)) - direction(at - glm::vec2(0, kStep));
    return glm::length(glm::cross(dx, dy)) / (4.0f * kStep * kStep);
}

} // namespace

TEST_CASE("direction and place on the map are each other's inverse, in both halves, plain and skewed")
{
    Random random;
    const Seen seen(camera({0, 0, 0}, {0, 0, -1}, 0.5f, 640, 360), lampAt({1, 2, 3}));
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 v = random.unit(), dense = random.unit();
        const ParaboloidSet set = i % 2 ? skewedHalves(seen.task, beside(dense), dense, random.in(0.0f, 0.78f), kSide,
                                                       kReach, MapCulling::none)
                                        : lowerAndUpper(seen.task, kSide, kReach, MapCulling::none);
        const gpu::Paraboloid& part = set.parts[glm::dot(v, set.firstWs) >= 0.0f ? 0 : 1];
        CHECK(glm::dot(glm::vec3(part.poleWs), v) >= 0.0f);
        const glm::vec3 local = gpu::inParaboloid(part, v);
        const glm::vec2 disc = gpu::paraboloidDisc(local);
        CHECK(glm::length(gpu::paraboloidDirection(disc) - local) < 1e-6f);
        // On the map: within its disc, clear of the border.
        const glm::vec2 at = gpu::paraboloidMap(part, disc);
        CHECK(glm::length(at) <= innerShare(kSide) + 2e-6f);
        CHECK(glm::length(gpu::paraboloidOfMap(part, at) - disc) < 2e-6f);
    }
}

TEST_CASE("all parts keep the winding: right x down is forward")
{
    const Seen seen(camera({0, 0, 0}, {0, 0, -1}, 0.5f, 640, 360), lampAt({1, 2, 3}));
    Random random;
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 dense = random.unit();
        for (const ParaboloidSet& set :
             {lowerAndUpper(seen.task, kSide, kReach, MapCulling::none),
              skewedHalves(seen.task, beside(dense), dense, 0.5f, kSide, kReach, MapCulling::none),
              cutToCone(seen.task, {dense, 0.8f}, kSide, kReach)}) {
            for (const gpu::Paraboloid& part : set.parts) {
                if (part.axisWs.w == 0.0f) continue; // a cone has one part
                const glm::mat3 axes(glm::vec3(part.rightWs), glm::vec3(part.downWs), glm::vec3(part.axisWs));
                CHECK(glm::determinant(axes) == Approx(1.0f).epsilon(1e-5));
            }
        }
    }
}

TEST_CASE("a texel at the centre of a disc sees four times the solid angle of one at the rim")
{
    const Seen seen(camera({0, 0, 0}, {0, 0, -1}, 0.5f, 640, 360), lampAt({1, 2, 3}));
    const gpu::Paraboloid part = lowerAndUpper(seen.task, kSide, kReach, MapCulling::none).parts[0];
    const float inner = innerShare(kSide);
    CHECK(solidAngle(part, {0, 0}) / solidAngle(part, inner * glm::vec2(0.6f, 0.8f)) == Approx(4.0f).epsilon(0.01));
}

TEST_CASE("a skewed hemisphere fills its disc, and its rim is denser by (1 + sin a) / (1 - sin a)")
{
    const Seen seen(camera({0, 0, 0}, {0, 0, -1}, 0.5f, 640, 360), lampAt({1, 2, 3}));
    Random random;
    const float inner = innerShare(kSide);
    for (const float degrees : {0.0f, 15.0f, 30.0f, 45.0f}) {
        CAPTURE(degrees);
        const float skew = glm::radians(degrees), s = std::sin(skew);
        const glm::vec3 dense = random.unit(), pole = beside(dense);
        const ParaboloidSet set = skewedHalves(seen.task, pole, dense, skew, kSide, kReach, MapCulling::none);
        const gpu::Paraboloid plain = lowerAndUpper(seen.task, kSide, kReach, MapCulling::none).parts[0];
        for (const std::size_t half : {0u, 1u}) {
            const gpu::Paraboloid& part = set.parts[half];
            for (float turn = 0.0f; turn < 6.28f; turn += 0.1f) {
                const glm::vec3 rim = std::cos(turn) * dense + std::sin(turn) * glm::cross(pole, dense);
                CHECK(glm::length(onMap(part, rim)) == Approx(inner).epsilon(1e-6));
            }
            const auto rimOf = [&](glm::vec3 direction) { return solidAngle(part, onMap(part, direction)); };
            const float plainRim = solidAngle(plain, {inner, 0.0f});
            CHECK(plainRim / rimOf(dense) == Approx((1.0f + s) / (1.0f - s)).epsilon(0.02));
            CHECK(rimOf(-dense) / plainRim == Approx((1.0f + s) / (1.0f - s)).epsilon(0.02));
        }
    }
}

TEST_CASE("the narrowest cone is no wider than any that a search finds")
{
    Random random;
    for (int i = 0; i < 50; ++i) {
        const glm::vec3 middle = random.unit();
        std::array<glm::vec3, 8> directions;
        for (glm::vec3& direction : directions)
            direction = glm::normalize(middle + 0.4f * random.unit());
        const Cone cone = coneAround(directions);
        const auto cosineAround = [&](glm::vec3 axis) {
            float cosine = 1.0f;
            for (glm::vec3 direction : directions)
                cosine = std::fmin(cosine, glm::dot(axis, direction));
            return cosine;
        };
        CHECK(cosineAround(cone.axis) == Approx(cone.cosine).epsilon(1e-5));
        glm::vec3 found = middle;
        for (int step = 0; step < 4000; ++step) {
            const glm::vec3 near = glm::normalize(found + random.in(0.0f, 0.1f) * random.unit());
            if (cosineAround(near) > cosineAround(found)) found = near;
        }
        CHECK(cone.cosine >= cosineAround(found) - 1e-5f);
        CHECK(cone.cosine <= cosineAround(found) + 0.02f); // and the search is worth its name
    }
    const std::array<glm::vec3, 2> opposite{glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0)};
    CHECK(coneAround(opposite).cosine == -1.0f);
}

TEST_CASE("a cut paraboloid shows all that is seen within range, and is scaled by 1 / tan(half angle / 2)")
{
    Random random;
    int cones = 0, none = 0, narrow = 0;
    for (int i = 0; i < 400; ++i) {
        const float range = i % 3 == 0 ? kUnlimitedRange : random.in(2.0f, 40.0f);
        const Seen seen(camera(random.vec(-20.0f, 20.0f), random.unit(), random.in(0.05f, 0.7f), 640, 360),
                        lampAt(random.vec(-20.0f, 20.0f), range));
        const Frustum frustum = frustumOf(seen.view, seen.lamp);
        const Cone cone = coneOf(frustum, seen.lamp.position(), range);
        const bool one = cone.cosine > 0.1f && cone.cosine < 1.0f;
        const ParaboloidSet set = one ? cutToCone(seen.task, cone, kSide, kReach) : ParaboloidSet{};
        const gpu::Paraboloid& part = set.parts[0];
        if (one) {
            ++cones;
            narrow += cone.cosine > 0.9f;
            const double half = std::acos(static_cast<double>(cone.cosine));
            CHECK(static_cast<double>(innerShare(kSide) / part.axisWs.w) == Approx(std::tan(0.5 * half)).epsilon(2e-4));
            CHECK(static_cast<double>(discRadius(0.5f)) == Approx(std::tan(std::acos(0.5) / 2.0)).epsilon(1e-6));
        }
        for (int k = 0; k < 200; ++k) {
            const glm::vec2 pixel(random.in(0.0f, 640.0f), random.in(0.0f, 360.0f));
            const glm::vec3 ray = gpu::viewRayWs(seen.view.constants, pixel);
            const glm::vec3 p = seen.view.eye + std::exp(random.in(-2.2f, 5.0f)) * ray,
                            fromLight = p - seen.lamp.position();
            const float distance = glm::length(fromLight);
            if (distance > range || !(distance > 1e-3f)) continue;
            CHECK(cone.cosine != 1.0f); // something is in range
            if (!one) continue;
            const glm::vec3 direction = fromLight / distance;
            CHECK(glm::dot(direction, cone.axis) >= cone.cosine - 1e-6f);
            CHECK(glm::length(onMap(part, direction)) <= innerShare(kSide) + 1e-5f);
            if (distance < kReach) CHECK(touches(Aabb{p, p}, set.volumes[0]));
        }
        none += cone.cosine == -1.0f;
    }
    CHECK(cones > 100);
    CHECK(narrow > 20);
    CHECK(none > 5); // lights in view
}

TEST_CASE("where the view looks is never a caster's own place, whatever the light's")
{
    Random random;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 eye = random.vec(-5.0f, 5.0f), forward = random.unit();
        const CameraView view = camera(eye, forward, 0.5f, 640, 360);
        const glm::vec3 lamp = i % 4 == 0   ? eye
                               : i % 4 == 1 ? eye + forward * random.in(0.0f, 5.0f)
                               : i % 4 == 2 ? eye - forward * random.in(0.0f, 5.0f)
                                            : random.vec(-1e6f, 1e6f);
        const glm::vec3 dense = beforeTheEye(view, lamp);
        CHECK(glm::length(dense) == Approx(1.0f));
        CHECK(std::fabs(glm::dot(dense, beside(dense))) < 1e-6f);
        if (lamp == eye) CHECK(glm::dot(dense, forward) > 0.99f);
    }
}
