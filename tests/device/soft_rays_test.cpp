// eight_point_hybrid and coherence_sampling from frame to frame: maps are kept while nothing moves, a picture depends
// neither on threads nor on what else is in the view, memory is what the plan is told, and what they refuse.
#include "algorithms/hybrid/eight_point_hybrid.hpp"
#include "device/memory_books.hpp"

#include <glm/geometric.hpp>

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kEight = "eight_point_hybrid";
constexpr const char* kCoherence = "coherence_sampling";
constexpr size_t kBall = 1;

Scene softScene(demo::LightKind kind)
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    if (kind == demo::LightKind::Directional) {
        scene.lights[0].kind = kind;
        scene.lights[0].direction = glm::normalize(glm::dvec3(0.4, -1.0, 0.3));
    }
    scene.lights[0].radius = kind == demo::LightKind::Directional ? 0.08f : 0.4f;
    return scene;
}

uint64_t between(const Image8& picture)
{
    uint64_t count = 0;
    for (const uint8_t value : picture.texels)
        count += value > 5 && value < 250;
    return count;
}

uint32_t mapsDrawn(const Host& host)
{
    uint32_t count = 0;
    for (const char* point : {"0", "1", "2", "3", "4", "5", "6", "7"})
        count += host.passCount(std::string("point_maps.casters.") + point);
    return count;
}

std::vector<Image8> freshPictures(const Scene& scene, const char* method, const HostOptions& options = {})
{
    Host host(scene, options);
    host.pinAll(method);
    host.require(host.draw());
    REQUIRE(std::string(host.decision(0).pMethod) == method);
    return host.pictures();
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "eight maps are drawn once, again when a caster moves, and equal a fresh context's")
{
    for (const demo::LightKind kind : {demo::LightKind::Spot, demo::LightKind::Directional}) {
        CAPTURE(static_cast<int>(kind));
        Host host(softScene(kind));
        host.pinAll(kEight);
        host.require(host.draw());
        CHECK(mapsDrawn(host) == 8);
        const std::vector<Image8> before = host.pictures();
        CHECK(between(before[0]) > 200);
        CHECK(dark(before[0]) > 100);
        for (int frame = 0; frame < 3; ++frame) {
            host.require(host.draw());
            CHECK(mapsDrawn(host) == 0);
            CHECK(host.stats().passesKept >= 8);
            if (frame == 2) CHECK(host.stats().deviceAllocations == 0); // buffers have gone round once
        }
        CHECK(differences(before, host.pictures()) == 0);
        host.scene.instances[kBall].pose.position.x += 0.4;
        host.require(host.draw());
        CHECK(mapsDrawn(host) == 8);
        CHECK(differences(before, host.pictures()) > 50);
        CHECK(differences(host.pictures(), freshPictures(host.scene, kEight)) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "coherence_sampling's picture is the same for any number of threads, and from frame to frame")
{
    for (const demo::LightKind kind : {demo::LightKind::Spot, demo::LightKind::Directional, demo::LightKind::Point}) {
        CAPTURE(static_cast<int>(kind));
        const Scene scene = softScene(kind);
        const auto threads = [](uint32_t count) {
            return HostOptions{.context = [count](GnContextCreateInfo& info) { info.jobThreadCount = count; }};
        };
        const std::vector<Image8> one = freshPictures(scene, kCoherence, threads(1));
        CHECK(between(one[0]) > 200);
        CHECK(dark(one[0]) > 100);
        Host host(scene, threads(5));
        host.pinAll(kCoherence);
        uint64_t rays = 0;
        for (int frame = 0; frame < 4; ++frame) {
            host.require(host.draw());
            CHECK(differences(one, host.pictures()) == 0);
            if (frame > 0) CHECK(host.stats().rays == rays);
            rays = host.stats().rays;
            if (frame == 3) CHECK(host.stats().deviceAllocations == 0);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "soft lights of one view are as they are alone")
{
    Scene scene = softScene(demo::LightKind::Spot);
    scene.lights.push_back(spotLight("second", {-3.0, 5.0, 2.0}, {0.0, 0.0, 0.0}, false));
    scene.lights[1].radius = 0.2f;
    for (const char* method : {kEight, kCoherence}) {
        const std::vector<Image8> both = freshPictures(scene, method);
        for (size_t light = 0; light < 2; ++light) {
            Scene one = scene;
            one.lights = {scene.lights[light]};
            CHECK(differences({both[light]}, freshPictures(one, method)) == 0);
            CHECK(between(both[light]) > 100);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "eight_point_hybrid holds what the plan is told")
{
    constexpr VkExtent2D extent{328, 180};
    const VkDeviceSize told = kEightPointHybrid.memoryFor(std::vector<double>{512.0}, extent);
    MemoryBooks books;
    Host host(softScene(demo::LightKind::Spot), books.options({.extent = extent}));
    host.pinAll(kEight);
    for (int frame = 0; frame < 4; ++frame) {
        host.scene.instances[kBall].pose.position.x += 0.05;
        host.require(host.draw());
    }
    CAPTURE(books.list());
    VkDeviceSize held = books.held("point_maps.").bytes + books.held("eight_point_hybrid.").bytes;
    CHECK(held > told / 4); // so few triangles that the static ones are not kept apart: half of the maps
    CHECK(held <= told + told / 8);
}

TEST_CASE_FIXTURE(DeviceTest, "point lights are left to coherence_sampling, suns above 45 degrees to none")
{
    Host host(softScene(demo::LightKind::Point));
    CHECK(gnSetLightMethod(host.context, host.lights[0], kEight) < 0);
    CHECK(host.lastError().find("'eight_point_hybrid' does not serve the kind of light") != std::string::npos);

    Scene sky = softScene(demo::LightKind::Directional);
    sky.lights[0].radius = 1.0f;
    for (const char* method : {kEight, kCoherence}) {
        Host wide(sky);
        wide.pinAll(method);
        wide.require(wide.draw());
        CHECK(wide.decision(0).reason != GN_REASON_PINNED);
        const std::string text = wide.explanation(0);
        CHECK_MESSAGE(text.find("sourceRadius above 0.7854") != std::string::npos, text);
    }
}
