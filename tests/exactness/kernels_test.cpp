// Kernels of percentage-closer filtering along the shadow of a straight edge: against the share of the kernel that is
// lit, and whether any light gets into the umbra.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "exactness/brute_stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{128, 96};
constexpr double kHeight = 1.0;
enum Kernel : uint32_t { kBox, kNearest, kTent, kDisc };
constexpr const char* kNames[] = {"box", "nearest", "tent", "disc"};

/// Weight of a place of the kernel, texels from its middle; of any scale.
double weightAt(Kernel kernel, double side, glm::dvec2 at)
{
    const glm::dvec2 size = glm::abs(at);
    if (kernel == kDisc) return glm::length(at) <= 0.5 * side ? 1.0 : 0.0;
    if (kernel == kTent) {
        const glm::dvec2 falls = glm::max(0.5 * (side + 1.0) - size, glm::dvec2(0.0));
        return falls.x * falls.y;
    }
    return std::max(size.x, size.y) <= 0.5 * side ? 1.0 : 0.0;
}

/// Share of the kernel on the side of a line to which `normal` (unit) points; `distance` from its middle, texels.
double shareLit(Kernel kernel, double side, glm::dvec2 normal, double distance)
{
    constexpr int kSteps = 40;
    const double width = side + 1.0;
    double lit = 0.0, all = 0.0;
    for (int y = 0; y < kSteps; ++y) {
        for (int x = 0; x < kSteps; ++x) {
            const glm::dvec2 at = width * ((glm::dvec2(x, y) + 0.5) / double(kSteps) - 0.5);
            const double weight = weightAt(kernel, side, at);
            all += weight;
            lit += glm::dot(normal, at) > distance ? weight : 0.0;
        }
    }
    return lit / all;
}

/// One layer of a light's map.
struct MapOf {
    GnLightMap map{};
    uint32_t layer = 0;
    double side = 0.0;

    glm::dvec2 texel(const glm::dvec3& world) const
    {
        const glm::dmat4 clip(glm::make_mat4(map.clipFromWorld[layer]));
        const glm::dvec4 at = clip * glm::dvec4(world - glm::make_vec3(map.origin), 1.0);
        return side * (0.5 + 0.5 * glm::dvec2(at) / at.w);
    }
};

struct Tally {
    uint64_t ramp = 0, dark = 0, lit = 0;     ///< Pixels on the ramp, and away from it on either side.
    uint64_t leaks = 0, specks = 0;           ///< Of dark, and of lit ones: not quite.
    double worst = 0.0, sum = 0.0, abs = 0.0; ///< Of the ramp's differences.
};

Tally tallyOf(const Stage& stage, const Image8& picture, const MapOf& map, Kernel kernel, double side)
{
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, 0);
    const brute::Scene casters(bruteTriangles(stage));
    Tally tally;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const auto px = static_cast<uint32_t>(x), py = static_cast<uint32_t>(y);
            const brute::Answer answer = brute::answerAt(view, light, casters, x, y, *stage.surfaces.depth.at(px, py),
                                                         drawnNormal(stage, px, py));
            if (answer.state != brute::State::asked || std::abs(answer.receiver.y) > 0.01) continue;
            if (std::abs(answer.receiver.z) > 3.0) continue; // within one face of a cube
            const glm::dvec2 a = map.texel({0.0, kHeight, -1.0}), b = map.texel({0.0, kHeight, 1.0});
            glm::dvec2 normal = glm::normalize(glm::dvec2(a.y - b.y, b.x - a.x));
            if (glm::dot(normal, map.texel({0.1, kHeight, 0.0}) - a) < 0.0) normal = -normal;
            const double into = glm::dot(normal, map.texel(answer.receiver) - a); // texels, towards the lit side
            // The corners of a kernel of one texel more than its side, and half a texel of the edge's stairs.
            const double reach = std::sqrt(0.5) * (side + 1.0) + 1.0;
            if (into < -reach) {
                ++tally.dark;
                tally.leaks += *picture.at(px, py) > 0;
            } else if (into > reach) {
                ++tally.lit;
                tally.specks += *picture.at(px, py) < 255;
            } else {
                ++tally.ramp;
                const double off = *picture.at(px, py) / 255.0 - shareLit(kernel, side, normal, -into);
                tally.worst = std::max(tally.worst, std::abs(off));
                tally.sum += off;
                tally.abs += std::abs(off);
            }
        }
    }
    return tally;
}

void check(LightKind kind, const char* method)
{
    Stage stage(halfPlane(kind, kHeight, 0.0f), kSize);
    const uint32_t mapSide = kind == LightKind::Directional ? 1024 : 256; // it covers the whole floor
    for (const Kernel kernel : {kBox, kNearest, kTent, kDisc}) {
        for (const uint32_t side : {3u, 7u, 15u}) {
            CAPTURE(std::string(kNames[kernel]) + " " + std::to_string(side));
            const Image8 picture = stage.draw(
                method, {{"resolution", double(mapSide)}, {"filter", double(side)}, {"kernel", double(kernel)}})[0];
            MapOf map{.map = {}, .layer = 0, .side = double(mapSide)};
            demo::Session& session = stage.session();
            REQUIRE(gnGetLightMap(session.shadows.context(), session.shadows.light(0), &map.map) == GN_SUCCESS);
            map.layer = kind == LightKind::Point ? 3 : 0; // downwards
            const Tally tally = tallyOf(stage, picture, map, kernel, side);
            const double pixels = double(tally.ramp);
            MESSAGE(std::string(method) << ", " << std::string(kNames[kernel]) << " " << side << ": " << tally.ramp
                                        << " pixels off by " << tally.abs / pixels << " on average, worst "
                                        << tally.worst << ", mean " << tally.sum / pixels << "; dark " << tally.dark
                                        << ", lit " << tally.lit);
            CHECK(tally.ramp > 100);
            CHECK(tally.dark > 500);
            CHECK(tally.lit > 500);
            CHECK(tally.leaks == 0);
            CHECK(tally.specks == 0);
            // The map's own edge has stairs of half a texel, and nearest texels make steps of one.
            CHECK(tally.worst <= 0.5 / side + 0.07);
            CHECK(tally.abs / pixels <= 0.12 / side + 0.01);
        }
    }
}

} // namespace

TEST_CASE("kernels show the share of them that is lit along an edge, all of it before and none behind")
{
    const test::DeviceTest silence;
    check(LightKind::Spot, "shadow_map");
    check(LightKind::Directional, "shadow_map");
    check(LightKind::Point, "cube_map");
}

} // namespace gnomon::exact
