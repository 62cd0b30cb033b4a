// penumbra_wedges on a device: what it keeps, that lights of one view do not disturb each other, and what it refuses.
#include "algorithms/entries.hpp"
#include "device/memory_books.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kMethod = "penumbra_wedges";
constexpr size_t kBall = 1;

Scene softScene(demo::LightKind kind, float radius)
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    scene.lights[0].radius = radius;
    return scene;
}

uint64_t between(const Image8& picture)
{
    uint64_t count = 0;
    for (const uint8_t value : picture.texels)
        count += value > 5 && value < 250;
    return count;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "silhouettes are found once for volumes and wedges, again when light or caster moved")
{
    for (const demo::LightKind kind : {demo::LightKind::Spot, demo::LightKind::Point}) {
        Host host(softScene(kind, 0.4f));
        host.pinAll(kMethod);
        host.require(host.draw());
        CHECK(host.stats().indexListsBuilt == 3); // the floor, the box, the ball: one list each, whatever reads them
        const std::vector<Image8> before = host.pictures();
        CHECK(between(before[0]) > 500);
        CHECK(dark(before[0]) > 100);
        for (int frame = 0; frame < 3; ++frame) {
            host.require(host.draw());
            CHECK(host.stats().indexListsBuilt == 0);
            CHECK(host.stats().passesKept >= 2);
            if (frame == 2) CHECK(host.stats().deviceAllocations == 0); // buffers have gone round once
        }
        CHECK(differences(before, host.pictures()) == 0);

        host.scene.instances[kBall].pose.position.x += 0.4;
        host.require(host.draw());
        CHECK(host.stats().indexListsBuilt == 1);
        CHECK(differences(before, host.pictures()) > 50);
        CHECK(host.decision(0).reason == GN_REASON_PINNED);

        Host smaller(softScene(kind, 0.1f));
        smaller.pinAll(kMethod);
        smaller.require(smaller.draw());
        CHECK(between(smaller.pictures()[0]) < between(before[0]) / 2);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "lights of one view are as they are alone, recorded or submitted")
{
    Scene scene = softScene(demo::LightKind::Spot, 0.4f);
    scene.lights.push_back(pointLight("bulb", {-2.0, 4.0, 1.0}, true));
    scene.lights[1].radius = 0.2f;
    Host both(scene);
    both.pinAll(kMethod);
    for (const Call call : {Call::submit, Call::record}) {
        both.require(both.draw({.call = call}));
        const std::vector<Image8> together = both.pictures();
        for (size_t light = 0; light < 2; ++light) {
            Scene one = scene;
            one.lights = {scene.lights[light]};
            Host alone(one);
            alone.pinAll(kMethod);
            alone.require(alone.draw());
            CHECK(differences({together[light]}, alone.pictures()) == 0);
            CHECK(between(together[light]) > 200);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "what a view takes is what the plan is told, however many lights")
{
    constexpr VkExtent2D extent{328, 180};
    const VkDeviceSize told = kPenumbraWedges.memoryFor(std::vector<double>{1.0, 0.0}, extent, GN_LIGHT_TYPE_SPOT);
    for (const size_t lights : {1u, 3u}) {
        MemoryBooks books;
        Scene scene = softScene(demo::LightKind::Spot, 0.4f);
        while (scene.lights.size() < lights) {
            scene.lights.push_back(pointLight("more", {-2.0, 4.0 + double(scene.lights.size()), 1.0}, true));
            scene.lights.back().radius = 0.2f;
        }
        Host host(scene, books.options({.extent = extent}));
        host.pinAll(kMethod);
        for (int frame = 0; frame < 4; ++frame)
            host.require(host.draw());
        CAPTURE(books.list());
        CHECK(books.held("penumbra_wedges.coverage").count == 1);
        VkDeviceSize held = books.held("penumbra_wedges.coverage").bytes;
        for (const char* name : {"volumes.depths", "volumes.depth_stencil", "volumes.bounds"})
            held += books.held(name).bytes;
        CHECK(held > told / 2);
        CHECK(held <= told + told / 8); // images may be padded
    }
}

TEST_CASE_FIXTURE(DeviceTest, "the sun is left to others")
{
    Scene scene = softScene(demo::LightKind::Spot, 0.4f);
    scene.lights[0].kind = demo::LightKind::Directional;
    scene.lights[0].radius = 0.005f;
    Host host(scene);
    CHECK(gnSetLightMethod(host.context, host.lights[0], kMethod) < 0);
    CHECK(host.lastError().find("'penumbra_wedges' does not serve the kind of light") != std::string::npos);
}
