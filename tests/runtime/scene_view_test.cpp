// Culling may say "touches" too often, never too seldom: checked with random points.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>

#include "runtime/scene/scene_view.hpp"

using namespace gnomon;

namespace {

struct Random {
    std::mt19937 engine{20};
    float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    glm::vec3 point(float size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
    glm::vec3 direction()
    {
        glm::vec3 v;
        do
            v = point(1.0f);
        while (glm::dot(v, v) > 1.0f || glm::dot(v, v) < 0.01f);
        return glm::normalize(v);
    }
    Aabb box(float spread)
    {
        const glm::vec3 center = point(spread), half = glm::abs(point(spread * in(0.0f, 0.7f)));
        return {center - half, center + half};
    }
    glm::vec3 inside(const Aabb& box)
    {
        return {in(box.lower.x, box.upper.x), in(box.lower.y, box.upper.y), in(box.lower.z, box.upper.z)};
    }
};

LightView lightOf(GnLightType type, glm::vec3 position, glm::vec3 direction, float range, float cone)
{
    LightView light{};
    light.type = type;
    light.constants.positionWs = glm::vec4(position, 1.0f);
    light.constants.directionWs = glm::vec4(direction, type == GN_LIGHT_TYPE_SPOT ? std::cos(cone) : -2.0f);
    light.constants.range = range;
    light.constants.type = static_cast<gpu::uint>(type);
    light.constants.sourceRadius = 0.0f;
    light.coneAngle = cone;
    return light;
}

} // namespace

TEST_CASE("no point of a box that is said to be outside a volume is inside it")
{
    Random random;
    int outside = 0;
    for (int i = 0; i < 4000; ++i) {
        const Aabb box = random.box(4.0f);
        std::array<Plane, 4> volume;
        for (Plane& plane : volume)
            plane = {random.direction(), random.in(-2.0f, 4.0f)};
        if (touches(box, volume)) continue;
        ++outside;
        for (int k = 0; k < 50; ++k) {
            const glm::dvec3 point(random.inside(box));
            bool inside = true;
            for (const Plane& plane : volume)
                inside = inside && glm::dot(glm::dvec3(plane.normal), point) + plane.distance >= 0.0;
            REQUIRE_FALSE(inside);
        }
    }
    CHECK(outside > 400);
    CHECK(touches(Aabb{}, std::span<const Plane>{}));
}

TEST_CASE("box and sphere touch exactly when the nearest point of the box is within the radius")
{
    const Aabb box{{-1, -2, -3}, {1, 2, 3}};
    CHECK(touches(box, {0, 0, 0}, 0.0f));
    CHECK(touches(box, {3, 0, 0}, 2.0f));
    CHECK_FALSE(touches(box, {3, 0, 0}, 1.999f));
    CHECK(touches(box, {4, 6, 3}, 5.0f)); // 3, 4, 0 away
    CHECK_FALSE(touches(box, {4, 6, 3.1f}, 5.0f));
}

TEST_CASE("no box that a spot light is said not to reach hides anything the light reaches")
{
    Random random;
    int missed = 0, reached = 0;
    for (int i = 0; i < 4000; ++i) {
        const float cone = random.in(0.02f, std::numbers::pi_v<float> / 2 - 0.02f);
        LightView light =
            lightOf(GN_LIGHT_TYPE_SPOT, random.point(3.0f), random.direction(), random.in(0.5f, 8.0f), cone);
        if (i % 2) light.constants.sourceRadius = random.in(0.0f, 1.0f);
        const Aabb box = random.box(5.0f);
        if (reaches(light, box)) {
            ++reached;
            continue;
        }
        ++missed;
        // A segment from the source to a point in cone and range must not meet the box.
        for (int k = 0; k < 60; ++k) {
            const glm::vec3 source =
                light.position() + random.direction() * random.in(0.0f, light.constants.sourceRadius);
            const glm::vec3 receiver = light.position() + random.direction() * random.in(0.0f, light.constants.range);
            if (!gpu::lightReaches(light.constants, receiver)) continue;
            for (int step = 0; step <= 20; ++step) {
                const glm::vec3 p = glm::mix(source, receiver, static_cast<float>(step) / 20.0f);
                const bool in =
                    glm::all(glm::greaterThanEqual(p, box.lower)) && glm::all(glm::lessThanEqual(p, box.upper));
                REQUIRE_FALSE(in);
            }
        }
    }
    CHECK(missed > 1000);
    CHECK(reached > 300);
}

TEST_CASE("a spot light does not reach boxes behind it, beside its cone or past its range")
{
    const LightView light = lightOf(GN_LIGHT_TYPE_SPOT, {0, 0, 0}, {0, 0, -1}, 10.0f, std::numbers::pi_v<float> / 4);
    const auto boxAt = [](float x, float y, float z) {
        return Aabb{glm::vec3(x, y, z) - 0.5f, glm::vec3(x, y, z) + 0.5f};
    };
    CHECK(reaches(light, boxAt(0, 0, -5)));
    CHECK(reaches(light, boxAt(5, 0, -5)));
    CHECK_FALSE(reaches(light, boxAt(0, 0, 1)));
    CHECK_FALSE(reaches(light, boxAt(7, 0, -5)));
    CHECK_FALSE(reaches(light, boxAt(0, 0, -11)));
    CHECK(reaches(light, Aabb{glm::vec3(-1), glm::vec3(1)})); // the light is in the box
    LightView wide = light;
    wide.constants.sourceRadius = 2.0f;
    CHECK(reaches(wide, boxAt(7, 0, -5)));
}

TEST_CASE("a spot light reaches a box that it points at, however small")
{
    Random random;
    for (int i = 0; i < 4000; ++i) {
        const glm::vec3 position = random.point(5.0f), center = random.point(5.0f);
        const glm::vec3 half = glm::abs(random.point(0.5f));
        const LightView light =
            lightOf(GN_LIGHT_TYPE_SPOT, position, glm::normalize(center - position), 50.0f, random.in(0.02f, 1.5f));
        CHECK(reaches(light, {center - half, center + half}));
    }
}

TEST_CASE("a point light reaches its range, a directional light everything")
{
    const LightView point = lightOf(GN_LIGHT_TYPE_POINT, {1, 0, 0}, {}, 2.0f, 0.0f);
    CHECK(reaches(point, {{3, 0, 0}, {4, 1, 1}}));
    CHECK_FALSE(reaches(point, {{3.01f, 0, 0}, {4, 1, 1}}));
    LightView unlimited = point;
    unlimited.constants.range = kUnlimitedRange;
    CHECK(unlimited.unlimited());
    CHECK(reaches(unlimited, {glm::vec3(1e9f), glm::vec3(2e9f)}));
    const LightView sun = lightOf(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0, -1, 0}, kUnlimitedRange, 0.0f);
    CHECK(reaches(sun, {glm::vec3(1e9f), glm::vec3(2e9f)}));
}

TEST_CASE("a transformed box holds every point that float arithmetic makes of its points")
{
    Random random;
    for (int i = 0; i < 2000; ++i) {
        const float size = std::exp2(random.in(-10.0f, 12.0f));
        const Aabb box = random.box(size);
        glm::mat3 basis;
        for (int column = 0; column < 3; ++column)
            basis[column] = random.point(2.0f);
        const glm::vec3 translation = random.point(1000.0f);
        const Aabb world = transformed(box, basis, translation);
        for (int k = 0; k < 8; ++k) {
            const glm::vec3 corner{k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                                   k & 4 ? box.upper.z : box.lower.z};
            for (const glm::vec3 p : {corner, random.inside(box)}) {
                const glm::vec3 image = basis * p + translation;
                REQUIRE(glm::all(glm::greaterThanEqual(image, world.lower)));
                REQUIRE(glm::all(glm::lessThanEqual(image, world.upper)));
            }
        }
        // And not much more than the corners need.
        const glm::vec3 extent = world.upper - world.lower;
        for (int row = 0; row < 3; ++row) {
            float exact = 0.0f, terms = std::abs(translation[row]);
            for (int column = 0; column < 3; ++column) {
                exact += std::abs(basis[column][row]) * (box.upper[column] - box.lower[column]);
                terms += std::abs(basis[column][row]) * 2.0f * size * 2.0f;
            }
            REQUIRE(extent[row] <= exact + 2e-6f * terms);
        }
    }
}
