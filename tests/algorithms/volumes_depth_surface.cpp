// The surface of a depth map: templates that fill cells, polygons that close, points where the light's matrix puts
// them.
#include <doctest/doctest.h>

#include <map>
#include <set>

#include "algorithms/volumes/depth_surface.hpp"
#include "maps_fixture.hpp"
#include "shaders/volumes_mccool_cap_frag.h"
#include "shaders/volumes_mccool_edges_comp.h"

using namespace gnomon;
using namespace gnomon::test;
using doctest::Approx;

namespace {

const auto kTemplates = cellTemplates();
const Aabb kScene{{-8.0f, -1.0f, -8.0f}, {8.0f, 5.0f, 8.0f}};

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edgeOf(std::uint32_t a, std::uint32_t b)
{
    return {std::min(a, b), std::max(a, b)};
}

struct Key {
    std::uint32_t jumps, variant;
};

std::vector<Key> allTemplates()
{
    std::vector<Key> all;
    for (std::uint32_t jumps = 0; jumps < 16; ++jumps)
        for (std::uint32_t variant = 0; variant < 3; ++variant)
            if (variant == 0 || gpu::jumpCount(jumps) == 3 || (gpu::jumpCount(jumps) == 4 && variant < 2))
                all.push_back({jumps, variant});
    return all;
}

std::span<const std::uint32_t> trianglesOf(std::uint32_t key)
{
    return std::span(kTemplates).subspan(key * gpu::TEMPLATE_TRIANGLES, gpu::triangleCountOf(key & 15u));
}

/// Twice the signed area, in half texels.
float areaOf(std::uint32_t triangle)
{
    const glm::vec2 a = gpu::placeOf(gpu::vertexOf(triangle, 0)), b = gpu::placeOf(gpu::vertexOf(triangle, 1)),
                    c = gpu::placeOf(gpu::vertexOf(triangle, 2));
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The vertices round a cell in order: corners, and two half-way along sides that jump.
std::vector<std::uint32_t> ringOf(std::uint32_t jumps)
{
    std::vector<std::uint32_t> ring;
    for (std::uint32_t side = 0; side < 4; ++side) {
        ring.push_back(side);
        if ((jumps >> side) & 1u) ring.insert(ring.end(), {4 + 2 * side, 5 + 2 * side});
    }
    return ring;
}

/// A map with a border of nothing around it, and the cells of mccool_edges.comp.
struct Map {
    int side;
    std::vector<float> depths;
    gpu::DepthSurface surface{};

    float at(int x, int y) const
    {
        const bool inside = x >= 0 && y >= 0 && x < side && y < side;
        return inside ? depths[static_cast<std::size_t>(y * side + x)] : gpu::NOTHING;
    }
    bool jumpsRight(int x, int y) const
    {
        return gpu::depthJumps(surface, at(x - 1, y), at(x, y), at(x + 1, y), at(x + 2, y));
    }
    bool jumpsDown(int x, int y) const
    {
        return gpu::depthJumps(surface, at(x, y - 1), at(x, y), at(x, y + 1), at(x, y + 2));
    }
    std::uint32_t jumps(int x, int y) const
    {
        return std::uint32_t(jumpsRight(x, y)) | (std::uint32_t(jumpsDown(x + 1, y)) << 1) |
               (std::uint32_t(jumpsRight(x, y + 1)) << 2) | (std::uint32_t(jumpsDown(x, y)) << 3);
    }
    glm::vec4 corners(int x, int y) const { return {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)}; }
};

/// Patches of planes, single texels and nothing: what makes all the templates.
/// @param turned the planes' slope, too steep to be smooth by itself, runs down the columns.
Map randomMap(Random& random, int side, bool turned)
{
    Map map{.side = side, .depths = std::vector<float>(static_cast<std::size_t>(side * side))};
    map.surface.tolerance = 0.01f;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const float kind = random.in(0.0f, 1.0f);
            float& depth = map.depths[static_cast<std::size_t>(y * side + x)];
            if (kind < 0.2f)
                depth = gpu::NOTHING;
            else if (kind < 0.6f)
                depth = 0.3f + 0.02f * float(turned ? y : x) + 0.005f * float(turned ? x : y);
            else if (kind < 0.8f)
                depth = 0.7f;
            else
                depth = random.in(0.0f, 0.9f);
        }
    }
    return map;
}

LightView lamp(GnLightType type, Random& random)
{
    if (type == GN_LIGHT_TYPE_DIRECTIONAL) return light(type, {}, random.unit(), kUnlimitedRange);
    return light(type, random.vec(6.0f, 9.0f), -glm::normalize(random.vec(0.2f, 1.0f)), 60.0f);
}

LightFit fitOf(const LightView& lamp, std::uint32_t face)
{
    if (lamp.type == GN_LIGHT_TYPE_DIRECTIONAL) return fitDirectional(lamp, kScene);
    return lamp.type == GN_LIGHT_TYPE_SPOT ? fitSpot(lamp, kScene) : fitCubeFace(lamp, kScene, face, 256, 4.0f);
}

constexpr GnLightType kTypes[] = {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT, GN_LIGHT_TYPE_POINT};

} // namespace

TEST_CASE("every template covers its cell once as the light sees it, and its rim is the ring of the cell's vertices")
{
    for (const Key& key : allTemplates()) {
        CAPTURE(key.jumps);
        CAPTURE(key.variant);
        float positive = 0.0f, negative = 0.0f;
        std::map<Edge, int> uses;
        for (const std::uint32_t triangle : trianglesOf(key.jumps + 16 * key.variant)) {
            const float area = areaOf(triangle);
            (area > 0.0f ? positive : negative) += area;
            for (std::uint32_t i = 0; i < 3; ++i) {
                CHECK(((gpu::cornersOf(triangle) >> gpu::cornerOf(gpu::vertexOf(triangle, i))) & 1u) == 1u);
                ++uses[edgeOf(gpu::vertexOf(triangle, i), gpu::vertexOf(triangle, (i + 1) % 3))];
            }
        }
        CHECK(std::max(positive, -negative) == 8.0f); // 2 x 2 half texels, doubled
        CHECK(std::min(positive, -negative) == 0.0f);

        std::set<Edge> rim, expected;
        for (const auto& use : uses) {
            CHECK(use.second <= 2);
            if (use.second == 1) rim.insert(use.first);
        }
        const std::vector<std::uint32_t> ring = ringOf(key.jumps);
        for (std::size_t i = 0; i < ring.size(); ++i)
            expected.insert(edgeOf(ring[i], ring[(i + 1) % ring.size()]));
        CHECK(rim == expected);
    }
}

TEST_CASE("the polygons of any map close: every edge is shared by two triangles of the surface")
{
    Random random;
    for (int round = 0; round < 40; ++round) {
        const Map map = randomMap(random, 12, round % 2 == 1);
        const auto side = static_cast<std::uint32_t>(map.side);
        std::map<Edge, int> uses;
        for (int y = -1; y < map.side; ++y) {
            for (int x = -1; x < map.side; ++x) {
                for (const std::uint32_t triangle : trianglesOf(gpu::templateOf(map.jumps(x, y), map.corners(x, y)))) {
                    std::uint32_t index[3];
                    for (std::uint32_t i = 0; i < 3; ++i)
                        index[i] = gpu::vertexIndex(side, x, y, gpu::vertexOf(triangle, i));
                    for (std::uint32_t i = 0; i < 3; ++i)
                        ++uses[edgeOf(index[i], index[(i + 1) % 3])];
                }
            }
        }
        for (const auto& use : uses) {
            const glm::vec2 a = gpu::indexPlace(side, use.first.first), b = gpu::indexPlace(side, use.first.second);
            const float last = static_cast<float>(side) + 0.5f;
            const bool rim = (a.x == b.x && (a.x == -0.5f || a.x == last)) ||
                             (a.y == b.y && (a.y == -0.5f || a.y == last)); // nothing, on both sides of it
            CHECK(use.second == (rim ? 1 : 2));
        }
    }
}

TEST_CASE("no triangle seen from the light lies between a caster and nothing")
{
    Random random;
    std::set<std::uint32_t> seen;
    for (int round = 0; round < 60; ++round) {
        const Map map = randomMap(random, 12, round % 2 == 1);
        for (int y = -1; y < map.side; ++y) {
            for (int x = -1; x < map.side; ++x) {
                const glm::vec4 corners = map.corners(x, y);
                const std::uint32_t key = gpu::templateOf(map.jumps(x, y), corners);
                seen.insert(key);
                for (const std::uint32_t triangle : trianglesOf(key)) {
                    if (areaOf(triangle) == 0.0f) continue; // a wall
                    int nothing = 0;
                    for (std::uint32_t i = 0; i < 3; ++i)
                        nothing += corners[static_cast<int>(gpu::cornerOf(gpu::vertexOf(triangle, i)))] >= gpu::NOTHING;
                    CHECK(nothing % 3 == 0);
                }
            }
        }
    }
    CHECK(seen.size() == allTemplates().size()); // all were tried
}

TEST_CASE("a vertex's index gives back its place and the texel with its depth")
{
    constexpr std::uint32_t kSide = 100;
    for (int y = -1; y < int(kSide); ++y) {
        for (int x = -1; x < int(kSide); x += 9) {
            for (std::uint32_t vertex = 0; vertex < 12; ++vertex) {
                const std::uint32_t index = gpu::vertexIndex(kSide, x, y, vertex), corner = gpu::cornerOf(vertex);
                const glm::vec2 place = gpu::indexPlace(kSide, index), texel = gpu::indexTexel(kSide, index);
                CHECK(place == glm::vec2(float(x), float(y)) + 0.5f + 0.5f * gpu::placeOf(vertex));
                CHECK(texel == glm::vec2(float(x), float(y)) + 0.5f * gpu::placeOf(corner));
            }
        }
    }
}

TEST_CASE("depth jumps at steps, not on slopes, creases or steps below a texel's width")
{
    gpu::DepthSurface surface{};
    surface.tolerance = 0.01f;
    const auto jumps = [&](float before, float a, float b, float after) {
        return gpu::depthJumps(surface, before, a, b, after);
    };
    CHECK_FALSE(jumps(0.5f, 0.5f, 0.5f, 0.5f));
    CHECK_FALSE(jumps(0.40f, 0.45f, 0.50f, 0.55f));  // a slope
    CHECK_FALSE(jumps(0.40f, 0.45f, 0.50f, 0.50f));  // its end
    CHECK_FALSE(jumps(0.50f, 0.50f, 0.505f, 0.49f)); // a step of half a texel
    CHECK(jumps(0.5f, 0.5f, 0.6f, 0.6f));
    CHECK(jumps(0.40f, 0.45f, 0.60f, 0.65f)); // a step between slopes
    CHECK(jumps(0.2f, 0.4f, 0.6f, 0.8f));     // even, but steeper than any face is believed to be
    CHECK(jumps(0.5f, 0.5f, 1.0f, 1.0f));
    CHECK(jumps(1.0f, 1.0f, 0.999f, 0.999f)); // however far away the caster
    CHECK_FALSE(jumps(0.5f, 1.0f, 1.0f, 0.5f));
    CHECK(jumps(1.0f, 0.45f, 0.50f, 1.0f)); // two texels alone have no slope
    for (const float step : {0.02f, 0.1f, 0.3f})
        CHECK(jumps(0.3f, 0.3f, 0.3f + step, 0.3f) == jumps(0.3f, 0.3f + step, 0.3f, 0.3f)); // whichever the direction
}

TEST_CASE("a point of the map lies where the light's matrix finds it again")
{
    Random random;
    int checked = 0;
    for (const GnLightType type : kTypes) {
        for (int i = 0; i < 200; ++i) {
            const LightView light = lamp(type, random);
            const LightFit fit = fitOf(light, static_cast<std::uint32_t>(i) % 6);
            const glm::vec3 eye = random.vec(-4.0f, 4.0f);
            const gpu::DepthSurface surface = depthSurface(fit, light, eye, 256);
            const glm::vec4 lightEs = type == GN_LIGHT_TYPE_DIRECTIONAL ? glm::vec4(light.direction(), 0.0f)
                                                                        : glm::vec4(light.position() - eye, 1.0f);
            const glm::vec2 texel(random.in(-0.5f, 256.5f), random.in(-0.5f, 256.5f));
            const float depth = random.in(0.0f, 0.99f);
            const glm::vec3 world = gpu::surfacePoint(surface, lightEs, texel, depth) + eye;
            // Closer, the world's own floats are too coarse to tell texels.
            if (surface.positional != 0.0f && glm::length(world - light.position()) < 0.25f) continue;
            ++checked;
            const glm::dvec4 clip = glm::dmat4(fit.clipFromWorld) * glm::dvec4(glm::dvec3(world), 1.0);
            CHECK(128.0 * (clip.x / clip.w + 1.0) == Approx(double(texel.x)).epsilon(1e-3));
            CHECK(128.0 * (clip.y / clip.w + 1.0) == Approx(double(texel.y)).epsilon(1e-3));
            CHECK(clip.z / clip.w == Approx(double(depth)).epsilon(1e-3));

            // The tolerance is what depth changes by when a point moves away from the light by a texel's width there.
            const float tolerance = surface.tolerance + surface.tolerancePerDepth * (surface.depthConstant - depth);
            const float deeper = depth + tolerance;
            const auto at = [&](float x, float y, float z) {
                return gpu::surfacePoint(surface, lightEs, glm::vec2(x, y), z);
            };
            const glm::vec3 centre = at(128.0f, 128.0f, depth);
            const float along = glm::length(at(128.0f, 128.0f, deeper) - centre);
            const float wide = std::max(glm::length(at(129.0f, 128.0f, depth) - centre),
                                        glm::length(at(128.0f, 129.0f, depth) - centre));
            CHECK(along == Approx(wide).epsilon(0.05));
        }
    }
    CHECK(checked > 300);
}

TEST_CASE("the texels about the near rectangle are those of all its points, and none lies deeper than said")
{
    Random random;
    int asked = 0;
    for (const GnLightType type : kTypes) {
        for (int i = 0; i < 200; ++i) {
            const LightView light = lamp(type, random);
            const LightFit fit = fitOf(light, static_cast<std::uint32_t>(i) % 6);
            const CameraView view = camera(random.vec(-6.0f, 6.0f), random.unit(), 0.4f, 640, 480);
            const NearTexels near = nearTexels(fit, view.nearCorners, 256);
            if (near.always) continue;
            for (int j = 0; j < 50; ++j) {
                const float s = random.in(0.0f, 1.0f), t = random.in(0.0f, 1.0f);
                const glm::vec3 p = glm::mix(glm::mix(view.nearCorners[0], view.nearCorners[1], s),
                                             glm::mix(view.nearCorners[3], view.nearCorners[2], s), t);
                const glm::dvec4 clip = glm::dmat4(fit.clipFromWorld) * glm::dvec4(glm::dvec3(p), 1.0);
                if (clip.w <= 1e-3) continue; // behind the light
                const glm::dvec2 at = 128.0 * (glm::dvec2(clip) / clip.w + 1.0) - 0.5;
                const double depth = clip.z / clip.w;
                if (depth <= 0.0) continue; // before the first caster
                CHECK(depth <= double(near.depth));
                for (const glm::dvec2& corner : {glm::floor(at), glm::floor(at) + 1.0}) {
                    const bool inMap = corner.x >= 0.0 && corner.y >= 0.0 && corner.x < 256.0 && corner.y < 256.0;
                    if (!inMap) continue;
                    ++asked;
                    CHECK(corner.x >= double(near.texels.x));
                    CHECK(corner.y >= double(near.texels.y));
                    CHECK(corner.x <= double(near.texels.z));
                    CHECK(corner.y <= double(near.texels.w));
                }
            }
        }
    }
    CHECK(asked > 1000);
}

TEST_CASE("the shaders that ask where depth jumps compute it as written, so that they say the same of a side")
{
    constexpr std::uint32_t kHeader = 5, kDecorate = 71, kNoContraction = 42;
    for (const std::span<const std::uint32_t> code : {std::span<const std::uint32_t>(k_volumes_mccool_cap_frag),
                                                      std::span<const std::uint32_t>(k_volumes_mccool_edges_comp)}) {
        std::size_t decorated = 0;
        for (std::size_t at = kHeader; at < code.size(); at += code[at] >> 16)
            decorated += (code[at] & 0xffffu) == kDecorate && code[at + 2] == kNoContraction;
        CHECK(decorated >= 5); // of the step, and of the tolerance's two sums, product and difference
    }
}
