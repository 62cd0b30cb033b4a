// Kernels of percentage-closer filtering along the shadow of a straight edge: against the share of the kernel that is
// lit, and whether any light gets into the umbra.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "exactness/brute_stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{128, 96};
constexpr double kHeight = 1.0;
enum Kernel : uint32_t { kBox, kNearest, kTent, kDisc };
constexpr const char* kNames[] = {"box", "nearest", "tent", "disc"};
constexpr const char* kRpcf = "rpcf"; // boxes of revectorized taps

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

/// along: the edge's direction, horizontal.
Tally tallyOf(const Stage& stage, const Image8& picture, const MapOf& map, Kernel kernel, double side,
              const glm::dvec3& along)
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
            if (std::abs(glm::dot(answer.receiver, along)) > 3.0) continue; // within one face of a cube
            const glm::dvec3 middle(0.0, kHeight, 0.0), lit(0.1 * along.z, 0.0, -0.1 * along.x);
            const glm::dvec2 a = map.texel(middle - along), b = map.texel(middle + along);
            glm::dvec2 normal = glm::normalize(glm::dvec2(a.y - b.y, b.x - a.x));
            if (glm::dot(normal, map.texel(middle + lit) - a) < 0.0) normal = -normal;
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

/// One picture of the edge of a sheet that is turned about the vertical by so many degrees.
class Edge {
public:
    Edge(LightKind kind, double degrees)
        : along_(std::sin(glm::radians(degrees)), 0.0, std::cos(glm::radians(degrees))), kind_(kind),
          stage_(turnedPlane(kind, degrees), kSize)
    {
    }

    Tally tally(const char* method, Kernel kernel, uint32_t side)
    {
        const uint32_t mapSide = kind_ == LightKind::Directional ? 1024 : 256; // it covers the whole floor
        Settings settings{{"resolution", double(mapSide)}, {"filter", double(side)}};
        if (method != kRpcf) settings.push_back({"kernel", double(kernel)});
        const Image8 picture = stage_.draw(method, settings)[0];
        MapOf map{.map = {}, .layer = 0, .side = double(mapSide)};
        demo::Session& session = stage_.session();
        REQUIRE(gnGetLightMap(session.shadows.context(), session.shadows.light(0), &map.map) == GN_SUCCESS);
        map.layer = kind_ == LightKind::Point ? 3 : 0; // downwards
        const Tally tally = tallyOf(stage_, picture, map, kernel, side, along_);
        const double pixels = double(tally.ramp);
        MESSAGE(std::string(method) << ", " << std::string(kNames[kernel]) << " " << side << ": " << tally.ramp
                                    << " pixels off by " << tally.abs / pixels << " on average, worst " << tally.worst
                                    << ", mean " << tally.sum / pixels << "; dark " << tally.dark << ", lit "
                                    << tally.lit);
        CHECK(tally.ramp > 100);
        CHECK(tally.dark > 500);
        CHECK(tally.lit > 500);
        CHECK(tally.leaks == 0);
        CHECK(tally.specks == 0);
        return tally;
    }

private:
    static Scene turnedPlane(LightKind kind, double degrees)
    {
        Scene scene = halfPlane(kind, kHeight, 0.0f);
        demo::Instance& sheet = scene.instances.back();
        sheet.pose.rotation = glm::angleAxis(glm::radians(degrees), glm::dvec3(0.0, 1.0, 0.0));
        sheet.pose.position = sheet.pose.rotation * (sheet.pose.position - glm::dvec3(0.0, kHeight, 0.0));
        sheet.pose.position.y += kHeight;
        return scene;
    }

    glm::dvec3 along_;
    LightKind kind_;
    Stage stage_;
};

void check(LightKind kind, const char* method)
{
    Edge edge(kind, 0.0);
    for (const Kernel kernel : {kBox, kNearest, kTent, kDisc}) {
        for (const uint32_t side : {3u, 7u, 15u}) {
            CAPTURE(std::string(kNames[kernel]) + " " + std::to_string(side));
            const Tally tally = edge.tally(method, kernel, side);
            // The map's own edge has stairs of half a texel, and nearest texels make steps of one.
            CHECK(tally.worst <= 0.5 / side + 0.07);
            CHECK(tally.abs / double(tally.ramp) <= 0.12 / side + 0.01);
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

// The thesis asks it of the same width (revectorized_test does that); here each has the width of its own kernel.
TEST_CASE("7 x 7 revectorized taps are nearer to the share of their box than 15 x 15 nearest texels to that of theirs")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Directional, LightKind::Point}) {
        double lines = 0.0, nearest = 0.0;
        for (const double degrees : {7.0, 20.0, 41.0}) {
            CAPTURE(degrees);
            Edge edge(kind, degrees);
            const char* plain = kind == LightKind::Point ? "cube_map" : "shadow_map";
            const Tally seven = edge.tally(kRpcf, kBox, 7), fifteen = edge.tally(plain, kNearest, 15);
            lines += seven.abs / double(seven.ramp);
            nearest += fifteen.abs / double(fifteen.ramp);
            CHECK(seven.worst <= 0.5 / 7.0 + 0.07);
        }
        MESSAGE(std::string(demo::nameOf(kind)) << ": rpcf " << lines / 3.0 << ", nearest " << nearest / 3.0);
        CHECK(lines <= nearest);
    }
}

} // namespace gnomon::exact
