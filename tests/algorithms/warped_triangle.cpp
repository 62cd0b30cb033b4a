// Triangles by edge functions, against rays in double precision: which texels' rays meet them, and how far away.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "shaders/warped/disc_triangle.h"

using namespace gnomon;

namespace {

constexpr float kSide = 256.0f;

/// Looks along +z from the zero; one texel is kSlope wide at distance 1, or kWidth wide without a perspective.
constexpr float kSlope = 1.0f / 128.0f, kWidth = 0.05f, kNear = 0.05f, kDeep = 40.0f;

gpu::WarpCaster casterOf(bool perspective, std::uint32_t flags)
{
    const float scale = perspective ? 1.0f / kSlope : 1.0f / kWidth;
    glm::mat4 m(0.0f);
    m[0][0] = scale;
    m[1][1] = scale;
    if (perspective) {
        m[2] = {0.5f * kSide, 0.5f * kSide, 0.0f, 1.0f};
    } else {
        m[2] = {0.0f, 0.0f, 1.0f / kDeep, 0.0f};
        m[3] = {0.5f * kSide, 0.5f * kSide, 0.0f, 1.0f};
    }
    gpu::WarpCaster caster{};
    caster.texelFromObject = m;
    caster.side = kSide;
    caster.depthConstant = perspective ? 1.0f : 0.0f;
    caster.depthScale = perspective ? -kNear : -1.0f;
    caster.flags = flags | (perspective ? gpu::WARP_CASTER_PERSPECTIVE : 0u);
    return caster;
}

struct Hit {
    double depth = 2.0;
    double edge = 0.0; ///< At most how far inside of the edges, texels; negative outside.
    bool away = false; ///< The face is turned from the light.
};

/// @param c source texels
Hit traced(bool perspective, const glm::dvec2& c, const glm::dvec3* corners)
{
    const glm::dvec2 middle = c - 0.5 * double(kSide);
    const glm::dvec3 from = perspective ? glm::dvec3(0.0) : glm::dvec3(middle * double(kWidth), 0.0);
    const glm::dvec3 way = perspective ? glm::dvec3(middle * double(kSlope), 1.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], n = glm::cross(e1, e2);
    const double t = glm::dot(corners[0] - from, n) / glm::dot(way, n);
    const glm::dvec3 p = from + t * way;
    double least = INFINITY;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 a = corners[(i + 1) % 3], b = corners[(i + 2) % 3];
        const glm::dvec3 inward = glm::normalize(glm::cross(n, b - a));
        least = std::min(least, glm::dot(p - a, inward));
    }
    Hit hit;
    const double across = std::fabs(glm::dot(glm::normalize(n), glm::normalize(way))); // what is left of it seen so
    hit.edge = least * across / (perspective ? std::fabs(t) * double(kSlope) : double(kWidth));
    if (perspective && t <= 0.0) hit.edge = -1e9;
    hit.depth = perspective ? 1.0 - double(kNear) / t : t / double(kDeep);
    hit.away = glm::dot(way, n) > 0.0;
    return hit;
}

} // namespace

TEST_CASE("texels' rays meet a triangle where edge functions say, at the depth they say")
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const bool perspective : {true, false}) {
        CAPTURE(perspective);
        std::uint32_t held = 0, crossing = 0, drawn = 0, wrong = 0, outside = 0;
        double depthError = 0.0;
        for (int i = 0; i < 20'000; ++i) {
            const double size = std::pow(10.0, 1.5 * unit(random));
            const glm::dvec3 about(8.0 * unit(random), 8.0 * unit(random), 12.0 + 13.0 * unit(random));
            glm::dvec3 corners[3];
            glm::vec3 given[3];
            for (int k = 0; k < 3; ++k) {
                given[k] = about + size * glm::dvec3(unit(random), unit(random), unit(random));
                corners[k] = given[k];
            }
            const bool mirrored = i % 3 == 0, backOnly = i % 2 == 0;
            const gpu::WarpCaster caster = casterOf(perspective, (mirrored ? gpu::WARP_CASTER_MIRRORED : 0u) |
                                                                     (backOnly ? gpu::WARP_CASTER_BACK_ONLY : 0u));
            const gpu::WarpTriangle t = gpu::warpTriangle(caster, given[0], given[1], given[2]);
            const bool any = t.box.x < t.box.z;
            drawn += any;
            crossing += perspective && any && std::min({corners[0].z, corners[1].z, corners[2].z}) < 0.0;
            for (int k = 0; k < 40; ++k) {
                const glm::dvec2 low(any ? glm::dvec2(t.box.x, t.box.y) : glm::dvec2(0.0));
                const glm::dvec2 high(any ? glm::dvec2(t.box.z, t.box.w) : glm::dvec2(double(kSide)));
                glm::dvec2 c = low + (high - low) * (0.5 + 0.5 * glm::dvec2(unit(random), unit(random)));
                if (k % 4 == 0) c = 0.5 * double(kSide) * (1.0 + glm::dvec2(unit(random), unit(random)));
                const Hit hit = traced(perspective, c, corners);
                if (std::fabs(hit.edge) < 0.05) continue; // either is right
                const glm::vec3 fromBase(c - glm::dvec2(t.base), 1.0);
                const bool inBox = any && c.x >= double(t.box.x) && c.x <= double(t.box.z) && c.y >= double(t.box.y) &&
                                   c.y <= double(t.box.w);
                const bool says = inBox && gpu::holdsPlace(t, fromBase);
                const bool expected = hit.edge > 0.0 && (!backOnly || hit.away != mirrored);
                outside += expected && !inBox;
                wrong += says != expected;
                if (!says || !expected) continue;
                ++held;
                const glm::dvec3 n = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
                const double steep = std::fabs(perspective ? glm::dot(n, glm::normalize(corners[0])) : n.z);
                if (steep < 0.01) continue; // depths of faces seen edge-on are as good as places
                const double depth = std::max(hit.depth, 0.0);
                depthError =
                    std::max(depthError, std::fabs(double(std::max(gpu::triangleDepth(t, fromBase), 0.0f)) - depth));
            }
        }
        MESSAGE("drawn " << drawn << ", across the light's plane " << crossing << ", held " << held << ", wrong "
                         << wrong << ", depth off by " << depthError);
        CHECK(held > 20'000);
        if (perspective) CHECK(crossing > 100);
        CHECK(outside == 0);
        CHECK(wrong == 0);
        CHECK(depthError < 2e-5);
    }
}

TEST_CASE("what is no triangle draws nothing")
{
    const float nan = std::nanf("");
    for (const bool perspective : {true, false}) {
        const gpu::WarpCaster caster = casterOf(perspective, 0);
        const glm::vec3 a(0.0f, 0.0f, 5.0f), b(1.0f, 0.0f, 5.0f), c(0.0f, 1.0f, 5.0f);
        const auto draws = [&](glm::vec3 p, glm::vec3 q, glm::vec3 r) {
            const gpu::WarpTriangle t = gpu::warpTriangle(caster, p, q, r);
            return t.box.x < t.box.z && t.box.y < t.box.w;
        };
        CHECK(draws(a, b, c));
        CHECK_FALSE(draws(a, a, a));
        CHECK_FALSE(draws(a, b, b));
        CHECK_FALSE(draws(a, {1.0f, 0.0f, 7.0f},
                          {1e-30f, 0.0f, 9.0f})); // edge-on with a perspective, or thinner than any texel
        CHECK_FALSE(draws({1e6f, 0.0f, 5.0f}, {1e6f, 1.0f, 5.0f}, {1e6f, 0.0f, 6.0f})); // beside the map
        CHECK_FALSE(draws({nan, nan, nan}, {nan, nan, nan}, {nan, nan, nan}));
        if (perspective) CHECK_FALSE(draws(-a, -b, -c)); // behind the light
    }
}

TEST_CASE(
    "on a paraboloid, texels' directions meet a triangle where planes through its edges say, at the depth they say")
{
    constexpr double kReach = 60.0;
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    gpu::WarpCaster caster{};
    caster.texelFromObject = glm::mat4(1.0f);
    caster.side = kSide;
    caster.depthScale = static_cast<float>(kReach);
    caster.disc = {0.1f, -0.2f, 0.45f * kSide, 1.0f / 3.0f};
    std::uint32_t held = 0, wide = 0, wrong = 0, outside = 0, boxes = 0;
    double depthError = 0.0, waste = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        const double size = std::pow(10.0, 1.5 * unit(random));
        const glm::dvec3 about(12.0 * unit(random), 12.0 * unit(random), 12.0 * unit(random));
        glm::dvec3 corners[3];
        glm::vec3 given[3];
        for (int k = 0; k < 3; ++k) {
            given[k] = about + size * glm::dvec3(unit(random), unit(random), unit(random));
            corners[k] = given[k];
        }
        const bool mirrored = i % 3 == 0, backOnly = i % 2 == 0;
        caster.flags = (mirrored ? gpu::WARP_CASTER_MIRRORED : 0u) | (backOnly ? gpu::WARP_CASTER_BACK_ONLY : 0u);
        const gpu::WarpTriangle t = gpu::discTriangle(caster, given[0], given[1], given[2]);
        const bool any = t.box.x < t.box.z;
        const glm::dvec3 n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double volume = glm::dot(n, corners[0]);
        glm::dvec2 least(1e9), most(-1e9);
        for (int k = 0; k < 60; ++k) {
            const glm::dvec2 low(any ? glm::dvec2(t.box.x, t.box.y) : glm::dvec2(0.0));
            const glm::dvec2 high(any ? glm::dvec2(t.box.z, t.box.w) : glm::dvec2(double(kSide)));
            glm::dvec2 c = low + (high - low) * (0.5 + 0.5 * glm::dvec2(unit(random), unit(random)));
            if (k % 4 == 0) c = 0.5 * double(kSide) * (1.0 + glm::dvec2(unit(random), unit(random)));
            const glm::vec3 asked = gpu::discDirection(caster, c);
            const glm::dvec2 disc = (c - 0.5 * double(kSide)) / double(caster.disc.z) + glm::dvec2(caster.disc);
            const double square = glm::dot(disc, disc);
            const glm::dvec3 way = glm::dvec3(2.0 * disc, 1.0 - square) / (1.0 + square);
            double edge = INFINITY; // sine of the angle from the nearest edge's plane, inside
            for (int j = 0; j < 3; ++j) {
                const glm::dvec3 plane = glm::cross(corners[j], corners[(j + 1) % 3]);
                edge = std::min(edge, std::copysign(1.0, volume) * glm::dot(plane, way) / glm::length(plane));
            }
            if (std::fabs(edge) * double(caster.disc.z) < 0.05) continue; // either is right
            const double along = volume / glm::dot(n, way);
            const bool inBox = any && c.x >= double(t.box.x) && c.x <= double(t.box.z) && c.y >= double(t.box.y) &&
                               c.y <= double(t.box.w);
            const bool says = inBox && gpu::holdsPlace(t, asked);
            const bool away = glm::dot(way, n) > 0.0;
            const bool expected = edge > 0.0 && along > 0.0 && (!backOnly || away != mirrored);
            if (expected && way.z < -1.0 / 3.0) continue; // past what the map says it shows
            outside += expected && !inBox;
            wrong += says != expected;
            if (!says || !expected) continue;
            ++held;
            wide += size > 10.0;
            least = glm::min(least, c);
            most = glm::max(most, c);
            const double steep = std::fabs(volume) / (glm::length(n) * glm::length(corners[0]));
            if (steep < 0.01) continue; // depths of faces seen edge-on are as good as directions
            depthError = std::max(depthError, std::fabs(double(gpu::discDepth(t, asked)) - along / kReach) /
                                                  std::max(along / kReach, 0.01));
        }
        // How tight the box is around one that lies before the light: what was held comes near its sides.
        if (any && most.x > least.x && size < 3.0) {
            ++boxes;
            waste += (most.x - least.x) / double(t.box.z - t.box.x);
        }
    }
    MESSAGE("held " << held << ", of wide ones " << wide << ", wrong " << wrong << ", depth off by a share of "
                    << depthError << "; what was found fills " << waste / boxes << " of the box");
    CHECK(held > 20'000);
    CHECK(wide > 1'000);
    CHECK(outside == 0);
    CHECK(wrong == 0);
    CHECK(depthError < 1e-4);
    CHECK(waste / boxes > 0.5);
}
