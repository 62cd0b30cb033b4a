// Which faces and halves a camera can need.
#include <doctest/doctest.h>

#include "algorithms/shared/frusta.hpp"
#include "maps_fixture.hpp"
#include "shaders/shared/cube.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

int facesNeeded(const CameraView& view, const LightView& lamp)
{
    int count = 0;
    for (std::uint32_t face = 0; face < 6; ++face)
        count += meetsPyramid(frustumOf(view, lamp), lamp.position(), cubeFaceEdges(face));
    return count;
}

} // namespace

TEST_CASE("a face in which a visible point within range lies is never left out, nor a half")
{
    Random random;
    for (int i = 0; i < 400; ++i) {
        const CameraView view = camera(random.vec(-20.0f, 20.0f), random.unit(), random.in(0.05f, 0.9f), 640, 360);
        const float range = i % 3 == 0 ? kUnlimitedRange : random.in(2.0f, 40.0f);
        const LightView lamp = light(GN_LIGHT_TYPE_POINT, random.vec(-20.0f, 20.0f), {0, -1, 0}, range);
        const Frustum frustum = frustumOf(view, lamp);
        for (int k = 0; k < 100; ++k) {
            const glm::vec2 pixel(random.in(0.0f, 640.0f), random.in(0.0f, 360.0f));
            const glm::vec3 p = view.eye + std::exp(random.in(-2.2f, 5.0f)) * gpu::viewRayWs(view.constants, pixel);
            const glm::vec3 fromLight = p - lamp.position();
            if (glm::length(fromLight) > range) continue;
            CHECK(meetsPyramid(frustum, lamp.position(), cubeFaceEdges(gpu::cubeFaceOf(fromLight))));
            const glm::vec3 inward(0.0f, fromLight.y > 0.0f ? 1.0f : -1.0f, 0.0f);
            CHECK(touches(frustum, Plane{inward, -glm::dot(inward, lamp.position())}));
        }
    }
}

TEST_CASE("a narrow view whose edge enters a face by next to nothing needs it all the same: far away that is metres")
{
    // Beside the border of the faces +x and +y, a centimetre from it. Towards it the lower edge runs by 2^-15, a
    // twentieth of a pixel: it gets there after 330 metres.
    const glm::vec3 border = glm::normalize(glm::vec3(1, 1, 0)), intoX = glm::normalize(glm::vec3(1, -1, 0));
    for (const float lower : {0x1p-15f, -0x1p-15f}) {
        Frustum frustum;
        frustum.bounded = false;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::vec3 aside(0.0f, 0.0f, i % 3 == 0 ? -0.01f : 0.01f);
            frustum.corners[i] = -0.01f * intoX + 0.01f * aside;
            frustum.runs[i] = border + (i < 2 ? -0.02f : lower) * intoX + aside;
        }
        CHECK(meetsPyramid(frustum, glm::vec3(0.0f), cubeFaceEdges(0)) == (lower > 0.0f));
        CHECK(meetsPyramid(frustum, glm::vec3(0.0f), cubeFaceEdges(2)));
    }
}

TEST_CASE("a near rectangle that is lost in rounding takes no face from a far eye")
{
    Random random;
    for (int i = 0; i < 4000; ++i) {
        CameraView view = camera(random.vec(-190.0f, 190.0f), random.unit(), random.in(0.1f, 0.6f), 640, 360);
        const glm::vec2 ring[4] = {{0, 0}, {640, 0}, {640, 360}, {0, 360}};
        const float near = i % 4 == 0 ? 1e-6f : i % 4 == 1 ? 1e-4f : 0.01f; // nothing, and coarse steps
        for (std::size_t k = 0; k < 4; ++k)
            view.nearCorners[k] = view.eye + near * gpu::viewRayWs(view.constants, ring[k]);
        // Straight ahead of a corner of the picture: a few faces just enter it.
        const glm::vec2 inward(320.0f, 180.0f);
        const glm::vec2 pixel = ring[i % 4] + 1e-3f * (inward - ring[i % 4]);
        const glm::vec3 seenPoint = view.eye + random.in(20.0f, 150.0f) * gpu::viewRayWs(view.constants, pixel);
        const glm::vec3 towards = random.unit();
        const float range = i % 3 == 0 ? kUnlimitedRange : 40.0f;
        const LightView lamp =
            light(GN_LIGHT_TYPE_POINT, seenPoint - random.in(1.0f, 30.0f) * towards, {0, -1, 0}, range);
        const std::uint32_t face = gpu::cubeFaceOf(seenPoint - lamp.position());
        CHECK(meetsPyramid(frustumOf(view, lamp), lamp.position(), cubeFaceEdges(face)));
    }
}

TEST_CASE("a light outside the view leaves out at least one face, one straight behind the camera five")
{
    Random random;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 forward = random.unit();
        const CameraView view = camera(random.vec(-5.0f, 5.0f), forward, 0.35f, 640, 480);
        const LightView lamp =
            light(GN_LIGHT_TYPE_POINT, view.eye - 6.0f * forward + 2.0f * random.unit(), {0, -1, 0}, 30.0f);
        CHECK(facesNeeded(view, lamp) <= 5);
    }
    const CameraView view = camera({0, 0, 0}, {0, 0, -1}, 0.3f, 100, 100);
    CHECK(facesNeeded(view, light(GN_LIGHT_TYPE_POINT, {0, 0, 10}, {0, -1, 0}, 40.0f)) == 1);
    CHECK(facesNeeded(view, light(GN_LIGHT_TYPE_POINT, {0, 0, 10}, {0, -1, 0}, kUnlimitedRange)) == 1);
}

TEST_CASE("a light in the middle of a wide view needs all faces the view covers and only those")
{
    // 45 degrees to each side from 10 m away: everything but what lies behind the eye's side of the light.
    const CameraView view = camera({0, 0, 10}, {0, 0, -1}, 0.6f, 100, 100);
    CHECK(facesNeeded(view, light(GN_LIGHT_TYPE_POINT, {0, 0, 0}, {0, -1, 0}, 40.0f)) == 6);
    CHECK(facesNeeded(view, light(GN_LIGHT_TYPE_POINT, {0, 0, -50}, {0, -1, 0}, 10.0f)) == 6);
    // Its range ends before the view begins to its right.
    CHECK(facesNeeded(view, light(GN_LIGHT_TYPE_POINT, {-60, 0, 0}, {0, -1, 0}, 10.0f)) <= 4);
}

TEST_CASE("a view below the light does not touch the upper half space")
{
    const CameraView view = camera({0, 12, 20}, glm::normalize(glm::vec3(0, -12, -20)), 0.39f, 640, 480);
    const Frustum frustum = frustumOf(view, light(GN_LIGHT_TYPE_POINT, {6, 14, 6}, {0, -1, 0}, 60.0f));
    CHECK_FALSE(touches(frustum, Plane{{0, 1, 0}, -14.0f}));
    CHECK(touches(frustum, Plane{{0, -1, 0}, 14.0f}));
}

TEST_CASE("a caster whose shadow, or that of a texel beside it, falls on a visible point is never left out")
{
    Random random;
    int left = 0, kept = 0;
    for (int i = 0; i < 4000; ++i) {
        const CameraView view = camera(random.vec(-20.0f, 20.0f), random.unit(), random.in(0.05f, 0.9f), 640, 360);
        const float range = i % 3 == 0 ? kUnlimitedRange : random.in(5.0f, 40.0f);
        const LightView lamp = light(GN_LIGHT_TYPE_POINT, random.vec(-20.0f, 20.0f), {0, -1, 0}, range);
        const Frustum frustum = frustumOf(view, lamp);
        const glm::vec3 middle = random.vec(-20.0f, 20.0f), half = random.vec(0.01f, 3.0f);
        const Aabb box{middle - half, middle + half};
        const float angle = random.in(0.0f, 0.1f);
        const bool seen = shadowMeets(frustum, lamp.position(), box, angle);
        (seen ? kept : left)++;
        for (int k = 0; k < 100 && !seen; ++k) {
            const glm::vec3 blocker = glm::mix(box.lower, box.upper, random.vec(0.0f, 1.0f)) - lamp.position();
            glm::vec3 ray = glm::normalize(glm::normalize(blocker) + 0.99f * angle * random.unit());
            const glm::vec3 p = lamp.position() + random.in(glm::length(blocker), 60.0f) * ray;
            if (glm::length(p - lamp.position()) > range) continue;
            bool inside = true;
            for (std::size_t side = 0; side < 4; ++side) {
                const glm::vec3 a = frustum.runs[side], b = frustum.runs[(side + 1) % 4];
                const glm::vec3 inward =
                    glm::cross(a, b) * (glm::dot(glm::cross(a, b), frustum.runs[(side + 2) % 4]) > 0 ? 1.0f : -1.0f);
                inside = inside && glm::dot(inward, p - view.eye) > 0.0f;
            }
            CHECK_FALSE(inside);
        }
    }
    CHECK(left > 1000);
    CHECK(kept > 200);
}
