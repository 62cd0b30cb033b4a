// Where shadows can be: the z-pass test, culling and screen bounds against dense samples.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "algorithms/volumes/shadow_reach.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "runtime/scene/shadow_pixels.hpp"
#include "shaders/volumes/wedge.h"
#include "tests/algorithms/volume_meshes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Whether the segment meets the box (slab test in double precision).
bool meets(const Aabb& box, glm::dvec3 from, glm::dvec3 to)
{
    double enter = 0.0, leave = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = to[axis] - from[axis];
        double t0 = (static_cast<double>(box.lower[axis]) - from[axis]) / d;
        double t1 = (static_cast<double>(box.upper[axis]) - from[axis]) / d;
        if (t0 > t1) std::swap(t0, t1);
        enter = std::max(enter, t0);
        leave = std::min(leave, t1);
    }
    return enter <= leave;
}

struct Setting {
    Aabb box;
    LightView light{};
    std::array<glm::vec3, 4> nearCorners;

    explicit Setting(Random& random)
    {
        const glm::vec3 c = random.inBox(glm::vec3(-4.0f), glm::vec3(4.0f));
        box = {c, c + random.inBox(glm::vec3(0.05f), glm::vec3(2.0f))};
        light = random(0.0f, 1.0f) < 0.4f ? directionalLight(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)))
                                          : pointLight(random.inBox(glm::vec3(-5.0f), glm::vec3(5.0f)));
        const glm::vec3 corner = random.inBox(glm::vec3(-2.0f), glm::vec3(2.0f));
        const glm::vec3 x = glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
        const glm::vec3 y = glm::normalize(glm::cross(x, random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f))));
        const float width = random(0.01f, 1.0f), height = random(0.01f, 1.0f);
        nearCorners = {corner, corner + width * x, corner + width * x + height * y, corner + height * y};
    }

    glm::dvec3 source(glm::dvec3 p) const
    {
        return light.type == GN_LIGHT_TYPE_DIRECTIONAL ? p - 1000.0 * glm::dvec3(light.direction())
                                                       : glm::dvec3(light.position());
    }

    bool anySampleShadowed(int steps) const
    {
        const glm::dvec3 a(nearCorners[0]), x = glm::dvec3(nearCorners[1]) - a, y = glm::dvec3(nearCorners[3]) - a;
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; j <= steps; ++j) {
                const glm::dvec3 p = a + x * (double(i) / steps) + y * (double(j) / steps);
                if (meets(box, p, source(p))) return true;
            }
        return false;
    }
};

CameraView camera(glm::vec3 eye, glm::vec3 target)
{
    CameraView view;
    view.eye = eye;
    view.area = {{0, 0}, {320, 200}};
    view.extent = {320, 200};
    const float nearPlane = 0.1f, half = std::tan(0.4f), aspect = 1.6f;
    glm::mat4 projection(0.0f); // reversed, infinite
    projection[0][0] = 1.0f / (half * aspect);
    projection[1][1] = -1.0f / half;
    projection[2][3] = -1.0f;
    projection[3][2] = nearPlane;
    const glm::mat4 viewFromWorld = glm::lookAt(eye, target, glm::vec3(0, 1, 0));
    const glm::mat4 clip = projection * viewFromWorld;
    view.projection = projection;
    view.viewFromWorld = glm::mat3(viewFromWorld);
    view.constants.clipFromWorld = clip;
    const auto row = [&](int i) { return glm::vec4(clip[0][i], clip[1][i], clip[2][i], clip[3][i]); };
    const glm::vec4 planes[5] = {row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) - row(2)};
    for (std::size_t i = 0; i < 5; ++i) {
        const float length = glm::length(glm::vec3(planes[i]));
        view.frustum[i] = {glm::vec3(planes[i]) / length, planes[i].w / length};
    }
    view.frustum[5] = {glm::vec3(0.0f), 1.0f};
    return view;
}

bool inside(const CameraView& view, glm::dvec3 p)
{
    return std::all_of(view.frustum.begin(), view.frustum.end(), [&](const Plane& plane) {
        return glm::dot(glm::dvec3(plane.normal), p) + static_cast<double>(plane.distance) >= 0.0;
    });
}

} // namespace

TEST_CASE("a caster passed for z-pass shadows no point of the near rectangle")
{
    Random random(1);
    int passed = 0, failed = 0;
    for (int i = 0; i < 20000; ++i) {
        const Setting s(random);
        if (shadowsNearRectangle(s.box, s.light, s.nearCorners)) {
            ++failed;
            continue;
        }
        ++passed;
        CHECK(!s.anySampleShadowed(12));
    }
    CHECK(passed > 2000);
    CHECK(failed > 500);
}

TEST_CASE("the z-pass test gives up few casters that shadow nothing of the near rectangle")
{
    Random random(2);
    int failed = 0, needless = 0;
    for (int i = 0; i < 20000; ++i) {
        const Setting s(random);
        if (!shadowsNearRectangle(s.box, s.light, s.nearCorners)) continue;
        ++failed;
        needless += !s.anySampleShadowed(40);
    }
    // What is left touches the pyramid between samples, or holds the light but no near point's view of it.
    CHECK(needless <= failed / 20);
}

TEST_CASE("a light in the plane of the near rectangle is no exception")
{
    const std::array<glm::vec3, 4> corners{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0),
                                           glm::vec3(0, 1, 0)};
    const LightView light = pointLight(glm::vec3(5.0f, 0.5f, 0.0f));
    CHECK(shadowsNearRectangle({{2.0f, 0.4f, -0.1f}, {3.0f, 0.6f, 0.1f}}, light, corners));
    CHECK(!shadowsNearRectangle({{2.0f, 0.4f, 0.1f}, {3.0f, 0.6f, 0.2f}}, light, corners));
    CHECK(!shadowsNearRectangle({{2.0f, 2.0f, -0.1f}, {3.0f, 3.0f, 0.1f}}, light, corners));
}

TEST_CASE("a shadow that is left out has no point in the frustum")
{
    Random random(4);
    const CameraView view = camera(glm::vec3(0.5f, 1.0f, 6.0f), glm::vec3(0.0f));
    int out = 0, in = 0;
    for (int i = 0; i < 4000; ++i) {
        Setting s(random);
        const glm::vec3 shift = random.inBox(glm::vec3(-8.0f), glm::vec3(8.0f));
        s.box.lower += shift;
        s.box.upper += shift;
        if (shadowTouches(s.box, s.light, view.frustum)) {
            ++in;
            continue;
        }
        ++out;
        for (int k = 0; k < 60; ++k) {
            const glm::dvec3 p(random.inBox(s.box.lower, s.box.upper));
            const glm::dvec3 ray = p - s.source(p);
            CHECK(!inside(view, p + ray * std::exp(static_cast<double>(random(-6.0f, 4.0f)))));
        }
    }
    CHECK(out > 500);
    CHECK(in > 500);
}

TEST_CASE("a penumbra that is left out has no point in the frustum")
{
    Random random(5);
    const CameraView view = camera(glm::vec3(0.5f, 1.0f, 6.0f), glm::vec3(0.0f));
    int out = 0, hardOut = 0;
    for (int i = 0; i < 6000; ++i) {
        Setting s(random);
        if (s.light.type == GN_LIGHT_TYPE_DIRECTIONAL) continue;
        const glm::vec3 shift = random.inBox(glm::vec3(-8.0f), glm::vec3(8.0f));
        s.box.lower += shift;
        s.box.upper += shift;
        const float radius = random(0.0f, 2.0f);
        hardOut += !shadowTouches(s.box, s.light, view.frustum);
        if (shadowTouches(s.box, s.light, view.frustum, radius)) continue;
        ++out;
        for (int k = 0; k < 60; ++k) {
            const glm::dvec3 p(random.inBox(s.box.lower, s.box.upper));
            const glm::dvec3 on(glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f))) * radius);
            const glm::dvec3 ray = p - (s.source(p) + on);
            CHECK(!inside(view, p + ray * std::exp(static_cast<double>(random(-6.0f, 4.0f)))));
        }
    }
    CHECK(out > 500);
    CHECK(hardOut > out);
}

TEST_CASE("bounds of a spot light hold its cone and touch it on some axis")
{
    Random random(5);
    for (int i = 0; i < 300; ++i) {
        LightView light = pointLight(random.inBox(glm::vec3(-3.0f), glm::vec3(3.0f)));
        light.type = GN_LIGHT_TYPE_SPOT;
        light.coneAngle = random(0.1f, 1.5f);
        const glm::vec3 direction = glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
        light.constants.directionWs = glm::vec4(direction, std::cos(light.coneAngle));
        light.constants.range = random(1.0f, 9.0f);
        const Aabb bounds = lightBounds(light);
        glm::vec3 low(1e9f), high(-1e9f);
        const glm::vec3 side = glm::normalize(glm::cross(direction, glm::vec3(0.3f, 0.9f, 0.1f)));
        const glm::vec3 up = glm::cross(side, direction);
        for (int k = 0; k < 4000; ++k) {
            const float angle = light.coneAngle * std::sqrt(random(0.0f, 1.0f)), turn = random(0.0f, 6.2831853f);
            const glm::vec3 ray =
                std::cos(angle) * direction + std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * up);
            const glm::vec3 p = light.position() + light.constants.range * (k % 8 ? 1.0f : random(0.0f, 1.0f)) * ray;
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        CHECK(glm::all(glm::lessThanEqual(bounds.lower, low + 1e-4f)));
        CHECK(glm::all(glm::greaterThanEqual(bounds.upper, high - 1e-4f)));
        CHECK(glm::all(glm::lessThan(low - bounds.lower, glm::vec3(0.12f * light.constants.range))));
        CHECK(glm::all(glm::lessThan(bounds.upper - high, glm::vec3(0.12f * light.constants.range))));
    }
}

TEST_CASE("no pixel outside a light's pixels shows a point in its range")
{
    Random random(6);
    const CameraView view = camera(glm::vec3(0.0f, 2.0f, 12.0f), glm::vec3(0.0f));
    int partial = 0, none = 0;
    for (int i = 0; i < 400; ++i) {
        LightView light = pointLight(random.inBox(glm::vec3(-12.0f), glm::vec3(12.0f)));
        light.constants.range = random(0.3f, 3.0f);
        const VkRect2D pixels = lightPixels(light, view);
        const bool any = pixels.extent.width != 0;
        if (!any)
            ++none;
        else if (pixels.extent.width < 320 && pixels.extent.height < 200)
            ++partial;
        for (int k = 0; k < 200; ++k) {
            glm::vec3 ray = random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f));
            if (glm::length(ray) > 1.0f) ray = glm::normalize(ray);
            const glm::vec3 p = light.position() + light.constants.range * ray;
            const glm::vec4 clip = view.constants.clipFromWorld * glm::vec4(p, 1.0f);
            if (clip.w < 0.1f || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) continue;
            REQUIRE(any);
            const float x = (0.5f + 0.5f * clip.x / clip.w) * 320.0f, y = (0.5f + 0.5f * clip.y / clip.w) * 200.0f;
            CHECK(x >= static_cast<float>(pixels.offset.x));
            CHECK(y >= static_cast<float>(pixels.offset.y));
            CHECK(x <= static_cast<float>(pixels.offset.x) + static_cast<float>(pixels.extent.width));
            CHECK(y <= static_cast<float>(pixels.offset.y) + static_cast<float>(pixels.extent.height));
        }
    }
    CHECK(partial > 50);
    CHECK(none > 50);
}

TEST_CASE("the pixels of shadow volumes are about those of their outlines")
{
    CameraView view = camera(glm::vec3(0.0f, 2.0f, 12.0f), glm::vec3(0.0f, 2.0f, 0.0f));
    const float pixelsPerMetre = 0.5f * 200.0f / std::tan(0.4f); // at depth 1
    view.constants.pixelSize = 1.0f / pixelsPerMetre;
    const LightView sun = directionalLight(glm::vec3(0.0f, -1.0f, 0.0f));
    Caster ground, cube;
    Topology topology; // a box's silhouette of six edges of half a metre, as a mesh that its instance doubles in size
    topology.whole.meanSides = 6.0f;
    topology.whole.meanSideLength = 3.0f;
    MeshView mesh;
    mesh.topology = &topology;
    cube.mesh = &mesh;
    cube.basis = glm::mat3(2.0f);
    ground.bounds = {glm::vec3(-6.0f, -0.02f, -6.0f), glm::vec3(6.0f, 0.0f, 6.0f)};
    cube.bounds = {glm::vec3(-0.5f, 3.0f, -0.5f), glm::vec3(0.5f, 4.0f, 0.5f)};
    const auto pixelsOf = [&](std::initializer_list<const Caster*> casters, const CameraView& from) {
        std::vector<const Caster*> all(casters);
        LightCasters lit;
        lit.all = all;
        return shadowPixels(sun, lit, from);
    };
    const double nothing = pixelsOf({&ground}, view);
    const double one = pixelsOf({&ground, &cube}, view) - nothing;
    // Six metres of edges on their way from the middle of the cube down to the ground, 12 m away; 20 pixels for every
    // pixel of the ways of six sides; four pieces of six sides, 200 pixels each.
    const double scale = double(pixelsPerMetre) / 12.0, way = 3.5 * scale;
    const double expected = way * 6.0 * scale + 20.0 * way * 6.0 + 4.0 * 200.0 * 6.0;
    MESSAGE(one << " pixels, of " << expected);
    CHECK(one > 0.9 * expected);
    CHECK(one < 1.1 * expected);
    const double two = pixelsOf({&ground, &cube, &cube}, view) - nothing;
    CHECK(two == doctest::Approx(2.0 * one)); // what overlaps counts each time
    CameraView away = camera(glm::vec3(0.0f, 2.0f, 12.0f), glm::vec3(0.0f, 2.0f, 24.0f)); // all behind the eye
    away.constants.pixelSize = view.constants.pixelSize;
    CHECK(pixelsOf({&ground, &cube}, away) == 0.0);
    CHECK(pixelsOf({}, view) == 0.0);
    // A lamp of unlimited range in the middle of its shade.
    LightView lamp = directionalLight(glm::vec3(0.0f, -1.0f, 0.0f));
    lamp.type = GN_LIGHT_TYPE_POINT;
    lamp.constants.positionWs = glm::vec4(0.0f, 3.5f, 0.0f, 1.0f);
    lamp.constants.range = kUnlimitedRange;
    const Caster* const shade[] = {&cube};
    LightCasters lit;
    lit.all = shade;
    CHECK(std::isfinite(shadowPixels(lamp, lit, view)));
}

TEST_CASE("a lamp within a building in one mesh is predicted the pixels of its pieces")
{
    CameraView view = camera(glm::vec3(0.0f, 2.0f, 12.0f), glm::vec3(0.0f, 2.0f, 0.0f));
    view.constants.pixelSize = 0.004f;
    const Mesh crate = boxMesh(glm::vec3(0.5f));
    const glm::vec3 places[] = {{-3, 1, 0}, {3, 1, 0}, {0, 1, -3}, {0, 5, 1}};
    const glm::mat3 doubled(2.0f);
    Mesh all;
    std::vector<std::unique_ptr<Placed>> apart;
    LightCasters lit;
    std::vector<const Caster*> pieces;
    for (const glm::vec3& place : places) {
        all = joined(all, crate, place);
        pieces.push_back(&apart.emplace_back(std::make_unique<Placed>(crate, doubled, 2.0f * place))->caster);
    }
    const Placed whole(all, doubled, glm::vec3(0.0f));
    REQUIRE(whole.topology.clusters.size() == 4);
    const LightView lamp = pointLight({0.3f, 2.5f, 0.2f});
    lit.all = pieces;
    const double expected = shadowPixels(lamp, lit, view);
    const Caster* const building[] = {&whole.caster};
    lit.all = building;
    CHECK(expected > 1e4);
    CHECK(shadowPixels(lamp, lit, view) == doctest::Approx(expected).epsilon(1e-3));
}

TEST_CASE("a near rectangle within a penumbra wedge is found to be there")
{
    Random random(11);
    int hulls = 0, beside = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const glm::vec3 from = random.inBox(glm::vec3(-2.0f), glm::vec3(2.0f));
        const glm::vec3 to = random.inBox(glm::vec3(-2.0f), glm::vec3(2.0f));
        const LightView light = pointLight(random.inBox(glm::vec3(-6.0f), glm::vec3(6.0f)));
        const float radius = random(0.01f, 1.5f);
        const gpu::Wedge wedge = gpu::penumbraWedge(from, to, light.position(), radius);
        if (wedge.whole != 0.0f) continue;
        ++hulls;
        const Aabb box{glm::min(from, to), glm::max(from, to)};
        for (int corner = 0; corner < 4; ++corner) {
            // On a ray, and somewhere between all of them.
            glm::vec3 eye = (corner < 2 ? from : to) + random(0.5f, 20.0f) * wedge.rays[corner];
            if (trial % 2 == 0)
                eye = glm::mix(from, to, random(0.0f, 1.0f)) + random(0.0f, 9.0f) * wedge.rays[0] +
                      random(0.0f, 9.0f) * wedge.rays[1] + random(0.0f, 9.0f) * wedge.rays[2] +
                      random(0.0f, 9.0f) * wedge.rays[3];
            constexpr float size = 1e-3f;
            const std::array<glm::vec3, 4> corners = {eye, eye + glm::vec3(size, 0, 0), eye + glm::vec3(size, size, 0),
                                                      eye + glm::vec3(0, size, 0)};
            CHECK(shadowsNearRectangle(box, light, corners, radius));
            beside += !shadowsNearRectangle(box, light, corners);
        }
    }
    CHECK(hulls > 3000);
    CHECK(beside > 3000); // a wedge is wider than the shadow
}
