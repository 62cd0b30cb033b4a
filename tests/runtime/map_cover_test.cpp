// How much of its maps a light's casters fill: against rays in all directions.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/scene/map_cover.hpp"
#include "tests/runtime/light_fixture.hpp"

using namespace gnomon;
using test::lightOf;

namespace {

constexpr int kRays = 20000;

struct Random {
    std::mt19937 engine{11};
    float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    glm::vec3 inBox(float half) { return {in(-half, half), in(-half, half), in(-half, half)}; }
    glm::vec3 direction()
    {
        glm::vec3 d = inBox(1.0f);
        while (glm::dot(d, d) > 1.0f || glm::dot(d, d) < 1e-4f)
            d = inBox(1.0f);
        return glm::normalize(d);
    }
    Aabb box(float spread, float largest)
    {
        const glm::vec3 middle = inBox(spread), half = glm::abs(inBox(largest)) + 0.05f;
        return {middle - half, middle + half};
    }
};

bool meets(const Aabb& box, glm::vec3 from, glm::vec3 ray)
{
    const glm::vec3 a = (box.lower - from) / ray, b = (box.upper - from) / ray;
    const glm::vec3 in = glm::min(a, b), out = glm::max(a, b);
    const float last = std::min({out.x, out.y, out.z});
    return last > 0.0f && std::max({in.x, in.y, in.z}) <= last;
}

MapCover coverOf(const LightView& light, std::span<const Aabb> boxes)
{
    std::vector<Caster> casters(boxes.size());
    std::vector<const Caster*> all;
    for (size_t i = 0; i < boxes.size(); ++i) {
        casters[i].bounds = boxes[i];
        all.push_back(&casters[i]);
    }
    LightCasters lit;
    lit.all = lit.statics = all;
    return mapCover(light, lit, all);
}

/// The face of the cube, in the order +X -X +Y -Y +Z -Z, that a direction leads through.
int faceOf(glm::vec3 d)
{
    const glm::vec3 size = glm::abs(d);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return 2 * axis + (d[axis] < 0.0f);
}

} // namespace

TEST_CASE("a point light's maps are filled and touched by what rays in all directions meet")
{
    Random random;
    double worst = 0.0;
    for (int i = 0; i < 60; ++i) {
        const LightView light =
            lightOf(GN_LIGHT_TYPE_POINT, random.inBox(3.0f), glm::vec3(0.0f, -1.0f, 0.0f), 100.0f, 0.0f);
        const std::array<Aabb, 1> box{random.box(8.0f, 3.0f)};
        int met = 0;
        std::array<bool, 6> faces{};
        for (int ray = 0; ray < kRays; ++ray) {
            const glm::vec3 d = random.direction();
            if (!meets(box[0], light.position(), d)) continue;
            ++met;
            faces[static_cast<size_t>(faceOf(d))] = true;
        }
        const MapCover cover = coverOf(light, box);
        const double share = double(met) / kRays;
        worst = std::max(worst, std::fabs(cover.filled - share) / (share + 0.01));
        // A corner that no ray found may touch a face; none that a ray found is missing.
        const auto found = static_cast<double>(std::count(faces.begin(), faces.end(), true));
        CHECK(6.0 * cover.touched >= found - 1e-9);
        CHECK(6.0 * cover.touched <= found + 2.0 + 1e-9);
    }
    MESSAGE("worst relative error of a share: " << worst);
    CHECK(worst < 0.15); // of which rays of a hundredth of the sphere have 0.07 themselves, one standard error
}

TEST_CASE("casters that overlap fill a map each, and one around the light fills all of it")
{
    const LightView light = lightOf(GN_LIGHT_TYPE_POINT, glm::vec3(0.0f), glm::vec3(0.0f, -1.0f, 0.0f), 100.0f, 0.0f);
    const Aabb room{glm::vec3(-4.0f), glm::vec3(4.0f)},
        block{glm::vec3(1.0f, -1.0f, -1.0f), glm::vec3(3.0f, 1.0f, 1.0f)};
    CHECK(coverOf(light, std::array{room}).filled == doctest::Approx(1.0));
    CHECK(coverOf(light, std::array{room}).touched == doctest::Approx(1.0));
    CHECK(coverOf(light, std::array{block}).filled ==
          doctest::Approx(1.0 / 6.0)); // its near side is a face of the cube
    CHECK(coverOf(light, std::array{block, block, room}).filled == doctest::Approx(4.0 / 3.0));
    CHECK(coverOf(light, {}).filled == 0.0);
    CHECK(coverOf(light, {}).touched == 0.0);
}

TEST_CASE("a spot light's map is filled by what its cone lights")
{
    const LightView light = lightOf(GN_LIGHT_TYPE_SPOT, glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f), 100.0f, 0.4f);
    const auto filled = [&](glm::vec3 lower, glm::vec3 upper) {
        const MapCover cover = coverOf(light, std::array{Aabb{lower, upper}});
        CHECK(cover.touched == 1.0);
        return cover.filled;
    };
    const float half = 10.0f * std::tan(0.4f); // of the map's side, at a distance of 10 m
    CHECK(filled({-half / 2, -half / 2, 10.0f}, {half / 2, half / 2, 10.01f}) == doctest::Approx(0.25).epsilon(0.1));
    CHECK(filled({-50.0f, -50.0f, 10.0f}, {50.0f, 50.0f, 10.5f}) == 1.0);
    CHECK(filled({-1.0f, -1.0f, -12.0f}, {1.0f, 1.0f, -10.0f}) == 0.0);
    const double whole = filled({-0.5f, -0.5f, 10.0f}, {0.5f, 0.5f, 11.0f});
    const double split = filled({half - 0.5f, -0.5f, 10.0f}, {half + 0.5f, 0.5f, 11.0f}); // across the cone's side
    CHECK(split > 0.3 * whole);
    CHECK(split < 0.7 * whole);
}

TEST_CASE("a caster that is a point on the very side of a cone fills nothing, and stays a number")
{
    const float half = std::acos(0.0f);
    const LightView light = lightOf(GN_LIGHT_TYPE_SPOT, glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f), 100.0f, half);
    const glm::vec3 point(10.0f, 0.0f, 0.0f);
    CHECK(coverOf(light, std::array{Aabb{point, point}}).filled == 0.0);
}

TEST_CASE("a directional light's map is filled by shadows on a plane across it")
{
    Random random;
    for (int i = 0; i < 20; ++i) {
        const glm::vec3 direction = random.direction();
        const LightView light = lightOf(GN_LIGHT_TYPE_DIRECTIONAL, glm::vec3(0.0f), direction, 100.0f, 0.0f);
        const Aabb ground{glm::vec3(-10.0f, -0.2f, -10.0f), glm::vec3(10.0f, 6.0f, 10.0f)};
        Aabb block = random.box(1.2f, 1.5f); // inside the other box once it is raised
        block.lower.y += 3.0f, block.upper.y += 3.0f;
        int inGround = 0, inBlock = 0;
        const glm::vec3 right = glm::normalize(glm::cross(direction, glm::vec3(0.3f, 0.9f, 0.2f)));
        const glm::vec3 up = glm::cross(right, direction);
        for (int ray = 0; ray < kRays; ++ray) {
            const glm::vec3 from = random.in(-20.0f, 20.0f) * right + random.in(-20.0f, 20.0f) * up - 50.0f * direction;
            inGround += meets(ground, from, direction);
            inBlock += meets(block, from, direction);
        }
        const std::array both{ground, block};
        const double expected = 1.0 + double(inBlock) / inGround;
        CHECK(coverOf(light, both).filled == doctest::Approx(expected).epsilon(0.03));
        CHECK(coverOf(light, both).touched == 1.0);
    }
}
