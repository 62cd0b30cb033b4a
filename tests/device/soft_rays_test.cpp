// eight_point_hybrid and coherence_sampling from frame to frame: maps are kept while nothing moves, a picture depends
// neither on threads nor on what else is in the view, memory is what the plan is told, and what they refuse.
#include "algorithms/entries.hpp"
#include "device/memory_books.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kEight = "eight_point_hybrid";
constexpr const char* kCoherence = "coherence_sampling";
constexpr size_t kBall = 1;

/// Soft lights of these kinds over a moving ball.
Scene softScene(std::initializer_list<demo::LightKind> kinds)
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    const demo::Light spot = scene.lights[0];
    scene.lights.clear();
    for (const demo::LightKind kind : kinds) {
        demo::Light light = kind == demo::LightKind::Point ? pointLight("bulb", {1.0, 5.0, 2.0}, true) : spot;
        light.radius = 0.4f;
        if (kind == demo::LightKind::Directional) {
            light.name = "sun";
            light.kind = kind;
            light.direction = glm::normalize(glm::dvec3(0.4, -1.0, 0.3));
            light.radius = 0.08f;
        }
        scene.lights.push_back(light);
    }
    return scene;
}

constexpr demo::LightKind kSpot = demo::LightKind::Spot, kSun = demo::LightKind::Directional,
                          kPoint = demo::LightKind::Point;

uint64_t between(const Image8& picture)
{
    uint64_t count = 0;
    for (const uint8_t value : picture.texels)
        count += value > 5 && value < 250;
    return count;
}

uint32_t mapsDrawn(const Host& host)
{
    return host.passCount("point_maps.casters");
}

/// What the view's pixels look at is flat around each but the edges': with reversed depth a plane's depths are a linear
/// function of the pixel, so that they bend by their rounding alone.
std::vector<bool> edgePixels(Host& host)
{
    const std::vector<std::byte> bytes = host.depthTexels();
    std::vector<float> depth(bytes.size() / sizeof(float));
    std::memcpy(depth.data(), bytes.data(), bytes.size());
    const size_t width = host.extent().width;
    REQUIRE(depth.size() == width * host.extent().height);
    const auto bends = [&](size_t i, size_t step) {
        const double bend = double(depth[i - step]) + depth[i + step] - 2.0 * depth[i];
        return std::abs(bend) > 1e-5 * depth[i];
    };
    std::vector<bool> edges(depth.size(), true);
    for (size_t i = width; i + width < depth.size(); ++i)
        edges[i] = i % width == 0 || i % width == width - 1 || bends(i, 1) || bends(i, width);
    return edges;
}

std::vector<Image8> picturesOf(Host& host, const char* method)
{
    host.pinAll(method);
    host.require(host.draw());
    for (size_t light = 0; light < host.lights.size(); ++light)
        REQUIRE(std::string(host.decision(light).pMethod) == method);
    return host.pictures();
}

void checkSoft(const std::vector<Image8>& pictures)
{
    for (const Image8& picture : pictures) {
        CHECK(between(picture) > 100);
        CHECK(dark(picture) > 100);
    }
}

/// Draws what stands still: nothing is made once buffers have gone round and each kind of frame was there, every eighth
/// being timed.
template <typename Check>
void checkSteady(Host& host, const Check& check)
{
    uint32_t made = 0;
    for (int frame = 0; frame < 24; ++frame) {
        host.require(host.draw());
        check();
        if (frame >= 16) made += host.stats().deviceAllocations;
    }
    CHECK(made == 0);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "eight maps are drawn once, again when a caster moves, and equal a fresh context's")
{
    MemoryBooks books;
    Host host(softScene({kSpot, kSun}), books.options());
    const std::vector<Image8> before = picturesOf(host, kEight);
    CHECK(mapsDrawn(host) == 2 * 8);
    checkSoft(before);
    checkSteady(host, [&] {
        CHECK(mapsDrawn(host) == 0);
        CHECK(host.stats().passesKept >= 2 * 8);
    });
    CHECK(differences(before, host.pictures()) == 0);
    host.scene.instances[kBall].pose.position.x += 0.4;
    host.require(host.draw());
    CHECK(mapsDrawn(host) == 2 * 8);
    CHECK(differences(before, host.pictures()) > 50);

    CAPTURE(books.list());
    const VkDeviceSize told =
        2 * kEightPointHybrid.memoryFor(std::vector<double>{512.0}, host.extent(), GN_LIGHT_TYPE_SPOT);
    const VkDeviceSize held = books.held("point_maps.").bytes + books.held("eight_point_hybrid.").bytes;
    CHECK(held > told / 4); // so few triangles that the static ones are not kept apart: half of the maps
    CHECK(held <= told + told / 8);

    Host fresh(host.scene);
    CHECK(differences(host.pictures(), picturesOf(fresh, kEight)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "coherence_sampling's picture is the same for any number of threads, and from frame to frame")
{
    const Scene scene = softScene({kSpot, kSun, kPoint});
    const auto threads = [](uint32_t count) {
        return HostOptions{.context = [count](GnContextCreateInfo& info) { info.jobThreadCount = count; }};
    };
    Host alone(scene, threads(1)), crowd(scene, threads(5));
    const std::vector<Image8> one = picturesOf(alone, kCoherence);
    checkSoft(one);
    CHECK(differences(one, picturesOf(crowd, kCoherence)) == 0);
    checkSteady(crowd, [&] { CHECK(crowd.stats().rays == alone.stats().rays); });
    CHECK(differences(one, crowd.pictures()) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "soft lights of one view are as they are alone")
{
    Scene scene = softScene({kSpot});
    scene.lights.push_back(spotLight("second", {-3.0, 5.0, 2.0}, {0.0, 0.0, 0.0}, false));
    scene.lights[1].radius = 0.2f;
    Host both(scene);
    const std::vector<Image8> together[] = {picturesOf(both, kEight), picturesOf(both, kCoherence)};
    for (size_t light = 0; light < 2; ++light) {
        Scene one = scene;
        one.lights = {scene.lights[light]};
        Host alone(one);
        CHECK(differences({together[0][light]}, picturesOf(alone, kEight)) == 0);
        CHECK(differences({together[1][light]}, picturesOf(alone, kCoherence)) == 0);
    }
}

// Boxes only: the facets of a ball face a light where its smooth normals no longer do.
TEST_CASE_FIXTURE(DeviceTest, "without normals flat surfaces have the same soft shadows, but for pixels at edges")
{
    Scene boxes = softScene({kSpot, kSun});
    boxes.instances[kBall].mesh = 2;
    boxes.instances[kBall].pose.rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, 0.5)));
    Host host(boxes);
    for (const char* method : {kEight, kCoherence}) {
        const std::vector<Image8> with = picturesOf(host, method);
        host.require(host.draw({.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) {
            views[0].normalImage = VK_NULL_HANDLE;
            views[0].normalView = VK_NULL_HANDLE;
            views[0].normalFormat = VK_FORMAT_UNDEFINED;
        }}));
        const std::vector<Image8> without = host.pictures();
        const std::vector<bool> edges = edgePixels(host);
        CHECK(10 * std::ranges::count(edges, true) < std::ssize(edges));
        for (size_t light = 0; light < 2; ++light) {
            size_t apart = 0, atEdges = 0;
            for (size_t i = 0; i < edges.size(); ++i)
                if (std::abs(int(with[light].texels[i]) - int(without[light].texels[i])) > 32)
                    ++(edges[i] ? atEdges : apart);
            MESSAGE(std::string(method) << ": apart in " << atEdges << " pixels at edges, in " << apart << " others");
            CHECK(apart == 0);
            CHECK(1000 * atEdges <= edges.size());
            CHECK(between(without[light]) > 100);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "point lights are left to coherence_sampling, suns above 45 degrees to others")
{
    Scene sky = softScene({kSun, kPoint});
    sky.lights[0].radius = 1.0f;
    Host host(sky);
    CHECK(gnSetLightMethod(host.context, host.lights[1], kEight) < 0);
    CHECK(host.lastError().find("'eight_point_hybrid' does not serve the kind of light") != std::string::npos);
    size_t asked = 0;
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        if (!(method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT) || !serves(method, kSun)) continue;
        CAPTURE(std::string(method.pName));
        host.pin(0, method.pName);
        host.require(host.draw());
        CHECK(std::string(host.decision(0).pMethod) != method.pName);
        const std::string text = host.explanation(0);
        CHECK_MESSAGE(text.find("sourceRadius above 0.7854") != std::string::npos, text);
        ++asked;
    }
    CHECK(asked >= 10);
    host.pin(0, "ray_traced"); // a hard shadow, whatever the radius, unless it takes samples
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "ray_traced");
    host.require(gnSetMethodSetting(host.context, "ray_traced", "samples", 2.0));
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) != "ray_traced");
    CHECK(host.explanation(0).find("sourceRadius above 0.7854") != std::string::npos);
}
