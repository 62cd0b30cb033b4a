// Penumbra wedges: what edges add to a count against areas that are counted point by point, and hulls against penumbra
// points that are made, not looked for.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "shaders/volumes/wedge.h"
#include "tests/algorithms/volume_meshes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Basis {
    glm::dvec3 x, y, z;
};

Basis around(const glm::dvec3& axis)
{
    const glm::dvec3 z = glm::normalize(axis);
    const glm::dvec3 x =
        glm::normalize(glm::cross(std::abs(z.x) < 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0), z));
    return {x, glm::cross(z, x), z};
}

/// A flat convex outline between receiver (the origin) and light: its corners go round left, seen from the light.
struct Outline {
    std::vector<glm::vec3> corners;
    glm::vec3 light;
    float radius = 0.0f;

    explicit Outline(Random& random)
    {
        light = random(3.0f, 8.0f) * glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
        radius = random(0.1f, 1.0f);
        const Basis basis = around(glm::dvec3(light));
        const double t = static_cast<double>(random(0.2f, 0.8f)) * static_cast<double>(glm::length(light));
        const glm::dvec3 centre = t * basis.z + static_cast<double>(random(-0.5f, 0.5f)) * basis.x;
        const double size = static_cast<double>(random(0.05f, 1.0f)), tilt = static_cast<double>(random(-0.5f, 0.5f));
        const auto count = 3 + static_cast<int>(random(0.0f, 5.0f));
        for (int i = 0; i < count; ++i) {
            // Counter-clockwise seen from the light, which looks back along z.
            const double angle = 2.0 * std::numbers::pi * (i + 0.3) / count;
            const glm::dvec3 aside = size * (std::cos(angle) * basis.x + std::sin(angle) * basis.y);
            corners.emplace_back(centre + aside + tilt * glm::dot(aside, basis.x) * basis.z);
        }
    }

    /// Whether the way from the origin to a point passes through the outline.
    bool crossedBy(const glm::dvec3& target) const
    {
        double least = 1e30, most = -1e30;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 a(corners[i]), b(corners[(i + 1) % corners.size()]);
            const double side = glm::dot(target, glm::cross(a, b));
            least = std::min(least, side);
            most = std::max(most, side);
        }
        return least > 0.0 || most < 0.0;
    }

    double coveredShare() const
    {
        constexpr int kSteps = 120;
        const Basis basis = around(glm::dvec3(light));
        int inside = 0, covered = 0;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const glm::dvec2 at(2.0 * (i + 0.5) / kSteps - 1.0, 2.0 * (j + 0.5) / kSteps - 1.0);
                if (glm::dot(at, at) > 1.0) continue;
                ++inside;
                covered +=
                    crossedBy(glm::dvec3(light) + static_cast<double>(radius) * (at.x * basis.x + at.y * basis.y));
            }
        return double(covered) / inside;
    }

    double coveredByEdges() const
    {
        double sum = crossedBy(glm::dvec3(light)) ? 1.0 : 0.0;
        for (std::size_t i = 0; i < corners.size(); ++i)
            sum +=
                static_cast<double>(gpu::edgeShare(corners[i], corners[(i + 1) % corners.size()], light, radius).share);
        return sum;
    }
};

} // namespace

TEST_CASE("a count from the light's centre and the shares of all edges give the covered part of the disc")
{
    Random random(1);
    int partly = 0;
    double worst = 0.0;
    for (int i = 0; i < 400; ++i) {
        const Outline outline(random);
        const double wanted = outline.coveredShare(), found = outline.coveredByEdges();
        partly += wanted > 0.02 && wanted < 0.98;
        worst = std::max(worst, std::abs(wanted - found));
    }
    MESSAGE("worst of 400: " << worst);
    CHECK(partly > 150);
    // The grid: 11 300 points, of which those along the border fall to either side by chance.
    CHECK(worst < 0.002);
}

TEST_CASE("an edge that no way to the source crosses adds nothing")
{
    const glm::vec3 light(0.0f, 0.0f, 5.0f);
    const auto share = [&](glm::vec3 from, glm::vec3 to) { return gpu::edgeShare(from, to, light, 0.5f).share; };
    CHECK(share({-1, 0.1f, -2}, {1, 0.1f, -2}) == 0.0f);     // behind the receiver
    CHECK(share({-1, 0.1f, 6}, {1, 0.1f, 6}) == 0.0f);       // behind the light
    CHECK(share({-1, 0.6f, 4.9f}, {1, 0.6f, 4.9f}) == 0.0f); // beside the source
    CHECK(share({0.3f, 0.01f, 2}, {1, 0.01f, 2}) == 0.0f);   // its line crosses the disc, the edge does not
    CHECK(share({1, 0.01f, 0}, {2, 0.01f, 0}) == 0.0f);      // level with the receiver
    CHECK(std::abs(share({-1, 0.01f, 2}, {1, 0.01f, 2})) > 0.4f);
}

TEST_CASE("shares are finite and at most half a disc, however edge and receiver meet")
{
    Random random(2);
    const float places[] = {0.0f, 1e-20f, 1e-6f, 1e-3f, 1.0f, 5.0f, 1e6f, -1e-6f, -1.0f, -5.0f};
    const auto any = [&] {
        const auto one = [&] { return places[static_cast<std::size_t>(random(0.0f, 9.99f))]; };
        return glm::vec3(one(), one(), one());
    };
    for (int i = 0; i < 200000; ++i) {
        const glm::vec3 light = any();
        if (glm::length(light) < 1e-3f) continue; // a receiver inside the source
        const float radius = random(0.0f, 1.0f) < 0.2f ? 1e-6f : random(1e-3f, 3.0f);
        const float share = gpu::edgeShare(any(), any(), light, radius).share;
        REQUIRE(std::isfinite(share));
        REQUIRE(std::abs(share) <= 0.5001f);
    }
}

namespace {

struct Ridge {
    glm::vec3 from, to, light;
    float radius;
    explicit Ridge(Random& random)
        : from(random.inBox(glm::vec3(-2.0f), glm::vec3(2.0f))), to(random.inBox(glm::vec3(-2.0f), glm::vec3(2.0f))),
          light(random.inBox(glm::vec3(-6.0f), glm::vec3(6.0f))), radius(random(0.01f, 1.5f))
    {
    }

    /// The hull's corners, with the rays' ends `reach` along x of the wedge.
    glm::dvec3 corner(const gpu::Wedge& wedge, std::uint32_t index, double reach) const
    {
        const glm::dvec3 tip(index == 0 || index == 2 || index == 3 ? from : to);
        return index < 2 ? tip : tip + reach * glm::dvec3(wedge.rays[(index + 2) & 3]);
    }
};

/// How far outside of the hull a point lies: the largest distance before one of its eight triangles.
double outside(const Ridge& ridge, const gpu::Wedge& wedge, double reach, const glm::dvec3& point)
{
    double most = -1e30;
    for (std::uint32_t part = 0; part < gpu::WEDGE_PARTS; ++part)
        for (std::uint32_t triangle = 0; triangle < 2; ++triangle) {
            glm::dvec3 p[3];
            for (std::uint32_t i = 0; i < 3; ++i)
                p[i] = ridge.corner(wedge, gpu::wedgeCorner(part, 3 * triangle + i), reach);
            const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
            most = std::max(most, glm::dot(glm::normalize(normal), point - p[0]));
        }
    return most;
}

} // namespace

TEST_CASE("the hull of an edge holds every point of its penumbra")
{
    Random random(3);
    int hulls = 0, whole = 0;
    for (int i = 0; i < 3000; ++i) {
        const Ridge ridge(random);
        const gpu::Wedge wedge = gpu::penumbraWedge(ridge.from, ridge.to, ridge.light, ridge.radius);
        if (wedge.whole != 0.0f) {
            ++whole;
            continue;
        }
        ++hulls;
        for (int k = 0; k < 40; ++k) {
            // From somewhere on the source through somewhere on the edge, and on.
            const glm::dvec3 direction = glm::normalize(glm::dvec3(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f))));
            const glm::dvec3 source = glm::dvec3(ridge.light) + static_cast<double>(ridge.radius) * direction;
            const glm::dvec3 q = glm::mix(glm::dvec3(ridge.from), glm::dvec3(ridge.to), double(random(0.0f, 1.0f)));
            const glm::dvec3 p = q + double(random(0.0f, 3.0f)) * (q - source);
            CHECK(outside(ridge, wedge, 1e4, p) <= 1e-3 * (1.0 + glm::length(p)));
        }
    }
    CHECK(hulls > 2000);
    CHECK(whole > 50);
}

TEST_CASE("where a hull is left out the source comes close to the edge's line, and always where closer than a fiftieth")
{
    Random random(4);
    for (int i = 0; i < 3000; ++i) {
        const Ridge ridge(random);
        const gpu::Wedge wedge = gpu::penumbraWedge(ridge.from, ridge.to, ridge.light, ridge.radius);
        const glm::dvec3 along = glm::normalize(glm::dvec3(ridge.to) - glm::dvec3(ridge.from));
        const glm::dvec3 toLight = glm::dvec3(ridge.light) - glm::dvec3(ridge.from);
        const double apart = glm::length(toLight - glm::dot(toLight, along) * along);
        // By the angle 1.29 at most: 1 / (1 - 2 / WEDGE_SPREAD^2).
        if (wedge.whole != 0.0f) CHECK(apart <= 1.29 * static_cast<double>(ridge.radius));
        if (wedge.whole == 0.0f) CHECK(apart >= 1.019 * static_cast<double>(ridge.radius));
    }
}

TEST_CASE("the hull is closed and wound outwards")
{
    Random random(5);
    int hulls = 0;
    for (int i = 0; i < 500; ++i) {
        const Ridge ridge(random);
        const gpu::Wedge wedge = gpu::penumbraWedge(ridge.from, ridge.to, ridge.light, ridge.radius);
        if (wedge.whole != 0.0f) continue;
        ++hulls;
        int uses[6][6] = {};
        for (std::uint32_t part = 0; part < gpu::WEDGE_PARTS; ++part)
            for (std::uint32_t k = 0; k < 6; ++k)
                ++uses[gpu::wedgeCorner(part, k)][gpu::wedgeCorner(part, k % 3 == 2 ? k - 2 : k + 1)];
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < 6; ++b)
                CHECK(uses[a][b] == uses[b][a]);
        glm::dvec3 centre(0.0);
        for (std::uint32_t k = 0; k < 6; ++k)
            centre += ridge.corner(wedge, k, 1.0) / 6.0;
        CHECK(outside(ridge, wedge, 1.0, centre) < 0.0);
    }
    CHECK(hulls > 300);
}
