// Points of a light's surface, and the lights at them.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "algorithms/shared/source_points.hpp"

using namespace gnomon;

namespace {

LightView spot(float radius)
{
    LightView light;
    light.type = GN_LIGHT_TYPE_SPOT;
    light.coneAngle = 0.7f;
    light.constants.positionWs = {1.0f, 5.0f, -2.0f, 1.0f};
    light.constants.directionWs = glm::vec4(glm::normalize(glm::vec3(0.3f, -1.0f, 0.2f)), std::cos(0.7f));
    light.constants.range = 20.0f;
    light.constants.sourceRadius = radius;
    return light;
}

} // namespace

TEST_CASE("of side^2 points one lies in each square, row and column")
{
    for (const std::uint32_t side : {2u, 5u, 17u}) {
        const std::uint32_t count = side * side;
        std::set<std::uint32_t> squares, rows, columns;
        for (std::uint32_t i = 0; i < count; ++i) {
            const glm::vec2 at = 0.5f * spreadPoint(i, side) + 0.5f; // in [0, 1]
            const auto part = [](float x, std::uint32_t n) { return std::uint32_t(x * float(n)); };
            squares.insert(side * part(at.y, side) + part(at.x, side));
            columns.insert(part(at.x, count));
            rows.insert(part(at.y, count));
        }
        CHECK(squares.size() == count);
        CHECK(*squares.rbegin() == count - 1);
        CHECK(columns.size() == count);
        CHECK(rows.size() == count);
    }
}

TEST_CASE("points of a sphere cover the disc that it shows, from whichever side")
{
    LightView light = spot(0.4f);
    SUBCASE("a spot") {}
    SUBCASE("a point light, which has no direction")
    {
        light.type = GN_LIGHT_TYPE_POINT;
        light.constants.directionWs = {0.0f, 0.0f, 0.0f, -2.0f};
    }
    constexpr std::uint32_t kSide = 17, kCount = kSide * kSide;
    for (const glm::vec3 axis : {glm::normalize(glm::vec3(0.3f, -1.0f, 0.2f)), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0),
                                 glm::vec3(0.6f, 0, 0.8f)}) {
        // Along a line across the axis a disc's points have a mean square of R^2 / 4; those of a ball have R^2 / 5.
        const glm::vec3 across = glm::normalize(glm::cross(axis, glm::vec3(0.2f, 0.3f, 0.9f)));
        double square = 0.0, mean = 0.0, farthest = 0.0;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const LightView point = lightAt(light, spreadOver(light, i, kSide), 1.0f);
            const glm::vec3 offset = point.position() - light.position();
            const double along = glm::dot(offset, across);
            square += along * along / kCount;
            mean += along / kCount;
            farthest = std::max(farthest, double(glm::length(offset)));
            CHECK(point.constants.sourceRadius == 0.0f);
        }
        CHECK(square == doctest::Approx(0.04).epsilon(0.03));
        CHECK(std::abs(mean) < 0.01);
        CHECK(farthest <= 0.4 + 1e-6);
    }
}

TEST_CASE("however an edge lies over a disc, the share of its points on one side is near that of the area")
{
    // Of 17 x 17 points the squares of spreadPoint() on a disc have an RMSE of 0.0088, random ones of 0.027.
    for (const auto& [side, most] : {std::pair{5u, 0.03}, std::pair{9u, 0.012}, std::pair{17u, 0.0045}}) {
        const std::uint32_t count = side * side;
        double squares = 0.0;
        constexpr int kTurns = 37, kSteps = 41;
        for (int turn = 0; turn < kTurns; ++turn)
            for (int step = 0; step < kSteps; ++step) {
                const double angle = 2.0 * std::numbers::pi * turn / kTurns, edge = 2.0 * (step + 0.5) / kSteps - 1.0;
                double share = 0.0;
                for (std::uint32_t i = 0; i < count; ++i) {
                    const glm::vec2 at = sunflowerPoint(i, count);
                    share += (at.x * std::cos(angle) + at.y * std::sin(angle) < edge) / double(count);
                }
                const double area = 1.0 - (std::acos(edge) - edge * std::sqrt(1.0 - edge * edge)) / std::numbers::pi;
                squares += (share - area) * (share - area) / (kTurns * kSteps);
            }
        CAPTURE(count);
        CHECK(std::sqrt(squares) < most);
    }
}

TEST_CASE("points of a flat disc cover it evenly, and none lies before or behind it")
{
    LightView light = spot(0.4f);
    light.sourceX = 0.4f * glm::normalize(glm::cross(light.direction(), glm::vec3(1, 0, 0)));
    light.sourceY = glm::cross(light.direction(), light.sourceX);
    light.sourceShape = GN_SOURCE_SHAPE_DISC;
    double square = 0.0;
    for (std::uint32_t i = 0; i < 289; ++i) {
        const LightView point = lightAt(light, spreadOver(light, i, 17), 1.0f);
        CHECK(!point.flat());
        const glm::vec3 offset = point.position() - light.position();
        CHECK(std::abs(glm::dot(offset, light.direction())) < 1e-6f);
        CHECK(glm::length(offset) <= 0.4f + 1e-6f);
        square += double(glm::dot(offset, light.sourceX)) * double(glm::dot(offset, light.sourceX)) / 0.16 / 289.0;
        const LightView corner = lightAt(light, pointAt(light, {1.0f, float(i) / 289.0f}, i), 1.0f); // the rim
        CHECK(glm::distance(corner.position(), light.position()) == doctest::Approx(0.4));
    }
    CHECK(square == doctest::Approx(0.04).epsilon(0.03)); // R^2 / 4
}

TEST_CASE("a point's cone holds what the light's own does from the nearest caster on")
{
    LightView light = spot(0.0f);
    light.constants.sourceRadius = 0.3f;
    light.sourceX = 0.5f * glm::normalize(glm::cross(light.direction(), glm::vec3(1, 0, 0)));
    light.sourceY = 0.2f * glm::normalize(glm::cross(light.direction(), light.sourceX));
    light.sourceShape = GN_SOURCE_SHAPE_RECTANGLE;
    const float nearest = 2.0f;
    for (std::uint32_t i = 0; i < 25; ++i) {
        const LightView point = lightAt(light, spreadOver(light, i, 5), nearest);
        CHECK(!point.rectangular());
        const glm::vec3 offset = point.position() - light.position();
        CHECK(std::abs(glm::dot(offset, light.direction())) < 1e-6f);
        CHECK(std::abs(glm::dot(offset, light.sourceX)) <= 0.25f);
        for (int turn = 0; turn < 16; ++turn) {
            const double angle = turn * std::numbers::pi / 8.0;
            const glm::vec3 rim = std::tan(light.coneAngle) * (float(std::cos(angle)) * glm::normalize(light.sourceX) +
                                                               float(std::sin(angle)) * glm::normalize(light.sourceY));
            for (const float distance : {nearest * std::cos(light.coneAngle), 5.0f, 15.0f}) {
                const glm::vec3 at = light.position() + distance * (light.direction() + rim);
                const float cosine = glm::dot(glm::normalize(at - point.position()), point.direction());
                CHECK(std::acos(cosine) <= point.coneAngle + 1e-4f);
            }
        }
    }
}

TEST_CASE("points of a sun turn it, by its own angle at most")
{
    LightView sun;
    sun.type = GN_LIGHT_TYPE_DIRECTIONAL;
    sun.constants.directionWs = glm::vec4(glm::normalize(glm::vec3(0.3f, -1.0f, 0.2f)), -2.0f);
    sun.constants.sourceRadius = 0.1f;
    float widest = 0.0f;
    for (std::uint32_t i = 0; i < 289; ++i) {
        const LightView point = lightAt(sun, spreadOver(sun, i, 17));
        CHECK(glm::length(point.direction()) == doctest::Approx(1.0));
        widest = std::max(widest, std::acos(std::min(glm::dot(point.direction(), sun.direction()), 1.0f)));
    }
    CHECK(widest <= 0.1f + 1e-4f);
    CHECK(widest > 0.09f);
}
