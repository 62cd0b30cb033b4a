// The edge functions of a conservative map, against points taken inside texels and triangles: exhaustively, in double
// precision, and without any of their formulas.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "algorithms/conservative_fixture.hpp"
#include "shaders/hybrid/conservative_lookup.h"
#include "shaders/hybrid/conservative_thesis.h"

using namespace gnomon;
using glm::dvec2;
using gpu::ConservativePush;
using gpu::ConservativeTriangle;
using test::kLampFar;
using test::kLampNear;
using test::lamp;
using test::SeenTriangle;

namespace {

constexpr float kSide = 64.0f;

ConservativePush straightDown(std::uint32_t flags = 0)
{
    // Larger errors than what the exact rays see: the bounds have to hold all the same.
    return test::straightDown(kSide, 1e-4f, flags);
}

struct Texel {
    bool drawn = false, touched = false, covered = false, held = false;
    double nearest = 0.0, farthest = 0.0;
};

Texel askedAt(const ConservativePush& push, const ConservativeTriangle& t, int x, int y)
{
    Texel texel;
    const dvec2 centre(x + 0.5, y + 0.5);
    texel.drawn = centre.x > double(t.rect.x) && centre.x < double(t.rect.z) && centre.y > double(t.rect.y) &&
                  centre.y < double(t.rect.w);
    if (!texel.drawn) return texel;
    const glm::vec2 c = glm::vec2(centre) - gpu::texelBase(t.rect);
    texel.touched = touches(t, c);
    texel.covered = covers(t, c);
    texel.held = holds(t, c);
    texel.nearest = double(nearDepth(push, t, c));
    texel.farthest = double(farDepth(push, t, c));
    return texel;
}

struct Count {
    int touched = 0, covered = 0, hit = 0;
};

#ifdef GNOMON_SANITIZED
constexpr int kRays = 4; // instrumented, each ray takes fifty times as long
#else
constexpr int kRays = 16;
#endif

/// Every texel against rays through it, kRays + 1 a side, its corners and sides among them.
Count checkAll(const ConservativePush& push, const std::array<glm::vec3, 3>& corners)
{
    const ConservativeTriangle t = conservativeTriangle(push, corners[0], corners[1], corners[2]);
    const SeenTriangle seen(push, corners);
    Count count;
    int missed = 0, uncovered = 0, above = 0, below = 0, unordered = 0;
    for (int y = 0; y < int(kSide); ++y) {
        for (int x = 0; x < int(kSide); ++x) {
            const Texel texel = askedAt(push, t, x, y);
            count.touched += texel.touched;
            count.covered += texel.covered;
            unordered += texel.covered && (!texel.touched || texel.nearest > texel.farthest);
            if (texel.held) missed += !seen.depthAt({x + 0.5, y + 0.5});
            bool any = false;
            for (int j = 0; j <= kRays; ++j) {
                for (int i = 0; i <= kRays; ++i) {
                    const auto depth = seen.depthAt({x + double(i) / kRays, y + double(j) / kRays});
                    any = any || depth;
                    missed += depth && !texel.touched;
                    uncovered += !depth && texel.covered;
                    const bool inMap = depth && *depth >= 0.0 && *depth <= 1.0;
                    above += inMap && texel.touched && *depth < texel.nearest;
                    below += inMap && texel.covered && *depth > texel.farthest;
                }
            }
            count.hit += any;
        }
    }
    CHECK(missed == 0);
    CHECK(uncovered == 0);
    CHECK(above == 0);
    CHECK(below == 0);
    CHECK(unordered == 0);
    return count;
}

} // namespace

TEST_CASE("every texel that a random triangle meets is touched, every one called covered is, within its depths")
{
    std::mt19937 random(11);
    const auto in = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    Count all;
    for (int i = 0; i < 120; ++i) {
        CAPTURE(i);
        const float size = std::exp2(in(-2.0f, 6.0f));
        const glm::vec3 at(in(0.0f, kSide), in(0.0f, kSide), in(0.1f, 0.9f));
        std::array<glm::vec3, 3> corners;
        for (glm::vec3& corner : corners)
            corner =
                glm::vec3(at.x + size * in(-1.0f, 1.0f), at.y + size * in(-1.0f, 1.0f), at.z + 0.1f * in(-1.0f, 1.0f));
        const Count now = checkAll(straightDown(), corners);
        all.touched += now.touched;
        all.covered += now.covered;
        all.hit += now.hit;
    }
    CHECK(all.covered > 1000);
    CHECK(all.touched < 1.2 * all.hit + 120 * 4); // and few texels more than are met
}

TEST_CASE("it is so about a lamp, for triangles that reach behind it as well")
{
    std::mt19937 random(12);
    const auto in = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    int crossing = 0, covered = 0;
    for (int i = 0; i < 120; ++i) {
        CAPTURE(i);
        const float size = std::exp2(in(-3.0f, 5.0f));
        const float w = in(0.5f, 8.0f);
        const glm::vec3 at(w * in(-1.0f, 1.0f), w * in(-1.0f, 1.0f), w);
        std::array<glm::vec3, 3> corners;
        for (glm::vec3& corner : corners)
            corner = at + size * glm::vec3(in(-1.0f, 1.0f), in(-1.0f, 1.0f), in(-1.0f, 1.0f));
        crossing += std::min({corners[0].z, corners[1].z, corners[2].z}) < 0.0f;
        covered += checkAll(lamp(kSide), corners).covered;
    }
    CHECK(crossing > 20);
    CHECK(covered > 1000);
}

TEST_CASE("a triangle whose inradius is below half a texel covers nothing, whichever way it winds")
{
    for (const float size : {0.05f, 0.3f, 0.8f, 1.2f, 1.6f}) {
        const std::array<glm::vec3, 3> corners = {glm::vec3(20.5f - 0.3f * size, 20.5f - 0.3f * size, 0.5f),
                                                  glm::vec3(20.5f + 0.7f * size, 20.5f - 0.3f * size, 0.5f),
                                                  glm::vec3(20.5f - 0.3f * size, 20.5f + 0.7f * size, 0.5f)};
        CHECK(checkAll(straightDown(), corners).covered == 0);
        CHECK(checkAll(straightDown(), {corners[0], corners[2], corners[1]}).covered == 0);
    }
}

TEST_CASE("a needle touches the texels it passes and at most one ring more")
{
    const std::array<glm::vec3, 3> needle = {glm::vec3(3.2f, 5.3f, 0.4f), glm::vec3(60.1f, 33.7f, 0.5f),
                                             glm::vec3(60.13f, 33.6f, 0.5f)};
    const Count count = checkAll(straightDown(), needle);
    CHECK(count.touched >= count.hit);
    CHECK(count.touched <= 3 * count.hit);
    CHECK(count.covered == 0);
}

TEST_CASE("what is seen edge-on covers nothing, and is not lost from the nearer layer")
{
    // A wall along the light, aslant in the map.
    const std::array<glm::vec3, 3> wall = {glm::vec3(10.25f, 10.5f, 0.2f), glm::vec3(40.25f, 25.5f, 0.2f),
                                           glm::vec3(10.25f, 10.5f, 0.9f)};
    for (const std::uint32_t flags : {0u, gpu::CASTER_BACK_ONLY, gpu::CASTER_BACK_ONLY | gpu::CASTER_MIRRORED}) {
        const ConservativePush push = straightDown(flags);
        const ConservativeTriangle t = conservativeTriangle(push, wall[0], wall[1], wall[2]);
        CHECK(t.range.w == 1.0f);
        for (int i = 0; i <= 300; ++i) {
            const dvec2 at(10.25 + 0.1 * i, 10.5 + 0.05 * i);
            const Texel texel = askedAt(push, t, int(at.x), int(at.y));
            CHECK(texel.touched);
            CHECK(texel.nearest <= 0.2);
            CHECK(!texel.covered);
        }
    }
}

TEST_CASE("a closed caster's faces towards the light are left out, and a mirrored one's other faces")
{
    // Seen from the light x runs right and y down: this one turns away, by the right-hand rule along the light.
    const std::array<glm::vec3, 3> away = {glm::vec3(5, 5, 0.5f), glm::vec3(50, 5, 0.5f), glm::vec3(5, 50, 0.5f)};
    const auto drawn = [](std::uint32_t flags, const std::array<glm::vec3, 3>& c) {
        return conservativeTriangle(straightDown(flags), c[0], c[1], c[2]).rect.z > 0.0f;
    };
    const std::array<glm::vec3, 3> towards = {away[0], away[2], away[1]};
    CHECK(drawn(gpu::CASTER_BACK_ONLY, away));
    CHECK(!drawn(gpu::CASTER_BACK_ONLY, towards));
    CHECK(!drawn(gpu::CASTER_BACK_ONLY | gpu::CASTER_MIRRORED, away));
    CHECK(drawn(gpu::CASTER_BACK_ONLY | gpu::CASTER_MIRRORED, towards));
    CHECK(drawn(0, towards));
}

TEST_CASE("on a plane of ten texels' slope the depth at the centre is wrong, the bounds are not")
{
    // Depth rises by 10 units of the last texel's width a texel.
    const auto depth = [](double x) { return 0.1 + 0.01 * x; };
    const std::array<glm::vec3, 3> slope = {glm::vec3(2, 2, depth(2)), glm::vec3(60, 2, depth(60)),
                                            glm::vec3(2, 60, depth(2))};
    checkAll(straightDown(), slope);
    const ConservativePush push = straightDown();
    const ConservativeTriangle t = conservativeTriangle(push, slope[0], slope[1], slope[2]);
    const Texel texel = askedAt(push, t, 20, 20);
    REQUIRE(texel.covered);
    const double centre = double(depthAt(t, glm::vec2(20.5f) - gpu::texelBase(t.rect)));
    CHECK(depth(20.1) < centre); // lit there, though the plane's centre says
    CHECK(texel.nearest <= depth(20.0));
    CHECK(texel.farthest >= depth(21.0));
    CHECK(texel.farthest - texel.nearest < 0.012);
}

TEST_CASE("outside the map, before its near end and in a texel known too roughly nothing is certain")
{
    gpu::ConservativeConstants constants{};
    gpu::MapLookup& look = constants.hybrid.base.map;
    look.side = kSide;
    look.positional = 1.0f;
    look.depthConstant = kLampFar / (kLampFar - kLampNear);
    look.depthScale = -kLampFar * kLampNear / (kLampFar - kLampNear);
    constants.texelsPerMetre = 2.0f * kSide;
    constants.depthSquare = 1.0f / -look.depthScale;
    const auto known = [&](float x, float y, float w, float error = 1e-6f) {
        return mapKnows(mapPointOf(constants, glm::vec4(x * w, y * w, 0.0f, w), error), w, kSide);
    };
    CHECK(known(30, 30, 5));
    CHECK(known(0.01f, 63.99f, 5));
    CHECK(!known(-0.1f, 30, 5));
    CHECK(!known(30, 64.1f, 5));
    CHECK(!known(30, 30, 0.2f));           // before the near end
    CHECK(!known(30, 30, -5.0f));          // behind the light
    CHECK(known(30.5f, 30.5f, 5, 0.001f)); // by 0.026 texels, in the middle of one
    CHECK(!known(30, 30.5f, 5, 0.001f));   // and at a border
    CHECK(!known(std::nanf(""), 30, 5));
}

TEST_CASE("a verdict is certain only where depth and its error lie on one side of a layer")
{
    CHECK(gpu::conservativeVerdict(0.5f, 0.6f, 0.4f, 0.01f, true) == 1.0f);
    CHECK(gpu::conservativeVerdict(0.5f, 0.6f, 0.495f, 0.01f, true) == 0.5f);
    CHECK(gpu::conservativeVerdict(0.5f, 0.6f, 0.605f, 0.01f, true) == 0.5f);
    CHECK(gpu::conservativeVerdict(0.5f, 0.6f, 0.7f, 0.01f, true) == 0.0f);
    CHECK(gpu::conservativeVerdict(1.0f, 1.0f, 2.0f, 0.01f, true) == 1.0f);  // nothing there, past the far end
    CHECK(gpu::conservativeVerdict(0.99f, 1.0f, 2.0f, 0.01f, true) == 0.5f); // something, which does not cover
    CHECK(gpu::conservativeVerdict(0.5f, 0.6f, 0.4f, 0.01f, false) == 1.0f); // where no ray reaches
    CHECK(gpu::conservativeVerdict(0.5f, 0.6f, 0.7f, 0.01f, false) == 0.5f);
}

TEST_CASE("what lies where rays end, an offset before the light, blocks none")
{
    for (const double near : {0.0005, 0.05}) {
        for (const double far : {1.0, 30.0, 2000.0}) {
            gpu::MapLookup look{};
            look.positional = 1.0f;
            look.depthConstant = static_cast<float>(far / (far - near));
            look.depthScale = static_cast<float>(-far * near / (far - near));
            for (double w = near / 8.0; w < far; w *= 1.07) {
                const float depth = std::max(look.depthConstant + look.depthScale / static_cast<float>(w), 0.0f);
                for (double offset = 1e-5; offset < 1.0; offset *= 1.5) {
                    const bool blocking = gpu::withinRays(look, depth, static_cast<float>(offset));
                    CHECK((!blocking || w > offset));
                    CHECK((blocking || w < near || w < 2.01 * offset));
                }
            }
        }
    }
    gpu::MapLookup sun{};
    sun.depthScale = -1.0f;
    for (const float depth : {0.0f, 0.5f, 1.0f})
        CHECK(gpu::withinRays(sun, depth, 0.1f));
}

namespace {

/// Areas of the thesis's cases, by counting points of a fine grid.
int thesisArea(const std::array<glm::vec3, 3>& corners, std::uint32_t keep)
{
    const ConservativeTriangle t = conservativeTriangle(straightDown(), corners[0], corners[1], corners[2]);
    int count = 0;
    for (float y = 0.125f; y < kSide; y += 0.25f)
        for (float x = 0.125f; x < kSide; x += 0.25f)
            count += thesisCovers(t, glm::vec2(x, y) - gpu::texelBase(t.rect), keep, 0u);
    return count;
}

double cross2(dvec2 a, dvec2 b)
{
    return a.x * b.y - a.y * b.x;
}

/// Intersection of two lines, each by a point and a direction.
dvec2 meet(dvec2 p, dvec2 u, dvec2 q, dvec2 v)
{
    return p + u * (cross2(q - p, v) / cross2(u, v));
}

bool inside(dvec2 p, dvec2 a, dvec2 b, dvec2 c)
{
    const double u = cross2(b - a, p - a), v = cross2(c - b, p - b), w = cross2(a - c, p - c);
    return (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
}

/// An edge's offset along its normal.
double offsetOf(dvec2 normal, std::uint32_t flags)
{
    if ((flags & gpu::CASTER_TIGHT) != 0) return 0.5 * (std::abs(normal.x) + std::abs(normal.y));
    return (flags & gpu::CASTER_DIAGONAL) != 0 ? std::sqrt(2.0) : std::sqrt(0.5);
}

void checkUnion(std::uint32_t flags)
{
    CAPTURE(flags);
    const std::array<glm::vec3, 3> corners = {glm::vec3(10, 12, 0.5f), glm::vec3(50, 16, 0.5f),
                                              glm::vec3(22, 48, 0.5f)};
    const dvec2 v[3] = {dvec2(corners[0]), dvec2(corners[1]), dvec2(corners[2])};
    // Edge i lies opposite to corner i; O(i) is moved inward by the offset.
    const auto from = [&](int i) { return v[(i + 1) % 3]; };
    const auto along = [&](int i) { return v[(i + 2) % 3] - v[(i + 1) % 3]; };
    const auto moved = [&](int i) {
        const dvec2 u = glm::normalize(along(i));
        dvec2 n(-u.y, u.x);
        if (glm::dot(n, v[i] - from(i)) < 0.0) n = -n;
        return from(i) + offsetOf(n, flags) * n;
    };
    const auto corner = [&](int i, bool iMoved, int j, bool jMoved) {
        return meet(iMoved ? moved(i) : from(i), along(i), jMoved ? moved(j) : from(j), along(j));
    };
    const ConservativeTriangle t = conservativeTriangle(straightDown(), corners[0], corners[1], corners[2]);
    for (std::uint32_t keep = 0; keep < 8; ++keep) {
        CAPTURE(keep);
        const auto kept = [&](int i) { return (keep >> i & 1u) != 0; };
        // The polygon's corners: at each of the triangle's, one, or two where both edges there are kept.
        std::vector<dvec2> polygon;
        for (int c = 0; c < 3; ++c) {
            const int before = (c + 1) % 3, after = (c + 2) % 3; // edges that end and begin at corner c
            if (kept(before) && kept(after)) {
                polygon.push_back(corner(before, false, after, true));
                polygon.push_back(corner(before, true, after, false));
            } else {
                polygon.push_back(corner(before, !kept(before), after, !kept(after)));
            }
        }
        int wrong = 0;
        for (double y = 8.03; y < 52.0; y += 0.37) {
            for (double x = 8.03; x < 52.0; x += 0.37) {
                bool in = false; // a fan; the polygon is convex
                for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
                    in = in || inside({x, y}, polygon[0], polygon[i], polygon[i + 1]);
                wrong += in != thesisCovers(t, glm::vec2(float(x), float(y)) - gpu::texelBase(t.rect), keep, flags);
            }
        }
        CHECK(wrong <= 2); // points on a border
        for (std::uint32_t more = 0; more < 8; ++more)
            if ((more & keep) == keep) CHECK(thesisArea(corners, more) >= thesisArea(corners, keep));
    }
}

} // namespace

TEST_CASE("the rule of kept edges is the union of the thesis's 1, 1, 2 and 4 triangles, by whatever edges move")
{
    for (const std::uint32_t flags : {0u, gpu::CASTER_TIGHT, gpu::CASTER_DIAGONAL})
        checkUnion(flags);
}
