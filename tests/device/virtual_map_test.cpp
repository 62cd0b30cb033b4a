// Pages of a virtual map: when they are drawn, which are kept, and what makes way for what.
#include <algorithm>

#include "device/posts.hpp"

namespace gnomon::test {
namespace {

using demo::CameraState;

constexpr const char* kMethod = "virtual_map";

/// Pages drawn in the newest frame, alone or over what stands still in them.
uint32_t pagesDrawn(const Host& host)
{
    return host.passCount("virtual_map.page") + host.passCount("virtual_map.page_evicting");
}

/// The same under a lamp among the posts.
Scene lampLand()
{
    Scene scene = land();
    scene.lights[0].kind = demo::LightKind::Point;
    scene.lights[0].position = glm::dvec3(2.0, 3.0, 1.0);
    scene.lights[0].range = 60.0f;
    return scene;
}

/// A host whose pool has so many texels a side.
void pinWith(Host& host, double resolution)
{
    host.require(gnSetMethodSetting(host.context, kMethod, "resolution", resolution));
    host.pinAll(kMethod);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a camera that stands still over casters that do draws no page, submitted or recorded")
{
    for (const Call call : {Call::submit, Call::record}) {
        for (const Scene& scene : {land(), lampLand()}) {
            CAPTURE(call == Call::record);
            CAPTURE(scene.lights[0].kind == demo::LightKind::Point);
            Host host(scene);
            pinWith(host, 1024.0);
            host.require(host.draw({.call = call}));
            const uint32_t first = pagesDrawn(host);
            CHECK(first > 20);
            CHECK(first <= 256);
            const std::vector<Image8> shown = host.pictures();
            CHECK(dark(shown[0]) > 100);
            for (int frame = 0; frame < 3; ++frame) {
                host.require(host.draw({.call = call}));
                CHECK(pagesDrawn(host) == 0);
                CHECK(host.passCount("virtual_map.statics") == 0);
                CHECK(host.passCount("virtual_map.table") == 0);
                CHECK(host.stats().passesKept == first);
                if (frame > 1) CHECK(host.stats().deviceAllocations == 0);
                CHECK(differences(host.pictures(), shown) == 0);
            }
        }
    }
}

// The lamp is in sight, and beside and behind the eye, so that receivers lie in all faces and across their borders.
TEST_CASE_FIXTURE(DeviceTest, "a lamp's pages are wrong on fewer pixels than six faces of 1.5 times their memory")
{
    const auto drawn = [](Host& host, const char* method, const char* setting, double value) {
        if (setting) host.require(gnSetMethodSetting(host.context, method, setting, value));
        host.pinAll(method);
        host.require(host.draw());
        return host.pictures();
    };
    size_t faces = 0, pages = 0, shadows = 0;
    for (const glm::dvec3& position :
         {glm::dvec3(2.0, 3.0, 1.0), glm::dvec3(-4.0, 2.5, 3.0), glm::dvec3(1.0, 4.0, 12.0)}) {
        Scene scene = lampLand();
        scene.lights[0].position = position;
        Host host(scene);
        const std::vector<Image8> truth = drawn(host, "ray_traced", nullptr, 0.0);
        const size_t six = differences(drawn(host, "cube_map", "resolution", 512.0), truth),
                     own = differences(drawn(host, kMethod, "resolution", 1024.0), truth);
        MESSAGE("lamp at " << position.x << ", " << position.y << ", " << position.z << ": of " << dark(truth[0])
                           << " dark pixels cube_map differs on " << six << ", pages on " << own);
        faces += six;
        pages += own;
        shadows += dark(truth[0]);
    }
    CHECK(shadows > 5'000);
    CHECK(pages < faces);
}

TEST_CASE_FIXTURE(DeviceTest, "a caster that moves has its own pages drawn, and nothing that stands still")
{
    Scene scene = land();
    scene.instances[1].isStatic = false; // the ball
    Host host(scene);
    pinWith(host, 1024.0);
    host.require(host.draw());
    const uint32_t all = pagesDrawn(host);
    host.require(host.draw());
    CHECK(pagesDrawn(host) == 0);
    uint32_t drawn = 0;
    for (int frame = 1; frame <= 6; ++frame) {
        host.scene.instances[1].pose.position.x += 0.01;
        host.require(host.draw());
        drawn = pagesDrawn(host);
        CHECK(drawn > 0);
        CHECK(drawn <= all / 3);
        // Pages that the ball comes to have what stands still in them drawn apart, once.
        CHECK(host.passCount("virtual_map.statics") <= 8);
    }
    CHECK(host.stats().passesKept >= all / 2);
}

TEST_CASE_FIXTURE(DeviceTest, "a walk draws a page or two a step, makes old pages way, and holds the memory it has")
{
    Host host(land());
    pinWith(host, 256.0); // 64 pages
    std::vector<CameraState> cameras{walked(host.scene, 0.0)};
    host.require(host.draw({.cameras = &cameras}));
    const uint32_t first = pagesDrawn(host);
    host.require(host.draw({.cameras = &cameras}));
    const VkDeviceSize memory = host.stats().memory;
    uint32_t drawn = 0, evicted = 0;
    constexpr int kSteps = 100; // 20 m
    for (int frame = 1; frame <= kSteps; ++frame) {
        cameras[0] = walked(host.scene, 0.2 * frame);
        host.require(host.draw({.cameras = &cameras}));
        drawn += pagesDrawn(host);
        evicted += host.passCount("virtual_map.page_evicting");
        CHECK(host.stats().memory <= memory + (1 << 20)); // the rings of constants grow
    }
    MESSAGE(first << " pages at first, then " << drawn << " in " << kSteps << " steps, " << evicted
                  << " in place of others");
    CHECK(drawn > 20);
    CHECK(drawn < 64 * kSteps / 4);
    CHECK(evicted > 10);
    CHECK(evicted <= drawn);
}

TEST_CASE_FIXTURE(DeviceTest, "pages that make way and pages without room are counted, and neither where all fit")
{
    for (const Scene& scene : {land(), lampLand()}) {
        CAPTURE(scene.lights[0].kind == demo::LightKind::Point);
        Host tight(scene), roomy(scene, {.extent = {64, 36}});
        pinWith(tight, 256.0);  // 64 pages
        pinWith(roomy, 2048.0); // 256
        uint32_t evicted = 0, drawn = 0;
        for (int frame = 0; frame < 8; ++frame) {
            std::vector<CameraState> cameras{walked(scene, 0.5 * frame)};
            tight.require(tight.draw({.cameras = &cameras}));
            CHECK(tight.stats().pagesEvicted == tight.passCount("virtual_map.page_evicting"));
            CHECK(tight.stats().pagesWithoutRoom > 0);
            evicted += tight.stats().pagesEvicted;
            roomy.require(roomy.draw({.cameras = &cameras}));
            CHECK(roomy.stats().pagesEvicted == 0);
            CHECK(roomy.stats().pagesWithoutRoom == 0);
            drawn += pagesDrawn(roomy);
        }
        MESSAGE(evicted << " pages made way for others; where all fit " << drawn << " were drawn");
        CHECK(evicted > 0);
        CHECK(drawn > 20);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "after walks, turns and moves, kept pages show what new ones do, bit for bit")
{
    for (Scene scene : {land(), lampLand()}) {
        CAPTURE(scene.lights[0].kind == demo::LightKind::Point);
        scene.instances[1].isStatic = false;
        Host kept(scene);
        pinWith(kept, 512.0);
        std::vector<CameraState> cameras{walked(scene, 0.0)};
        for (int frame = 1; frame <= 24; ++frame) {
            cameras[0] = walked(scene, frame < 12 ? 0.3 * frame : 0.3 * (24 - frame));
            cameras[0].target.x += 0.2 * (frame % 5);
            if (frame % 3 == 0) kept.scene.instances[1].pose.position.x += 0.07;
            kept.require(kept.draw({.cameras = &cameras}));
            if (frame % 8 != 0) continue;
            Host fresh(kept.scene);
            pinWith(fresh, 512.0);
            fresh.require(fresh.draw({.cameras = &cameras}));
            CHECK(differences(kept.pictures(), fresh.pictures()) == 0);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that is dropped leaves the pages as they were")
{
    Host host(land());
    pinWith(host, 256.0);
    std::vector<CameraState> here{walked(host.scene, 0.0)}, there{walked(host.scene, 8.0)};
    host.require(host.draw({.call = Call::record, .cameras = &here}));
    const std::vector<Image8> shown = host.pictures();
    host.require(host.draw({.call = Call::record, .cameras = &there, .drop = true}));
    host.require(host.draw({.call = Call::record, .cameras = &here}));
    CHECK(differences(host.pictures(), shown) == 0);
    host.require(host.draw({.call = Call::record, .cameras = &here}));
    CHECK(pagesDrawn(host) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "64 suns or lamps hold the memory predicted for them, each its own shadows")
{
    for (Scene scene : {land(), lampLand()}) {
        const demo::Light light = scene.lights[0];
        CAPTURE(light.kind == demo::LightKind::Point);
        scene.lights.clear();
        for (int i = 0; i < 64; ++i) {
            demo::Light& each = scene.lights.emplace_back(light);
            each.name = "light " + std::to_string(i);
            const glm::dvec3 beside(std::cos(0.1 * i), -1.0, std::sin(0.1 * i));
            each.direction = glm::normalize(beside);
            each.position -= 2.0 * beside;
        }
        Host host(scene, {.extent = {96, 64}, .maxLights = 64});
        host.require(host.draw());
        const VkDeviceSize before = host.stats().memory;
        pinWith(host, 128.0); // 16 pages
        host.draw(2, {});
        const VkDeviceSize held = host.stats().memory - before;
        MESSAGE("64 pools of 16 pages: " << held / 1024 << " KiB");
        CHECK(held <= 64u * (128u * 128u * 8u + (512u << 10)));
        uint32_t shadows = 0;
        for (const Image8& picture : host.pictures())
            shadows += dark(picture) > 10;
        CHECK(shadows == 64);
        std::vector<CameraState> cameras{walked(scene, 6.0)};
        host.require(host.draw({.cameras = &cameras}));
        CHECK(host.stats().pagesEvicted > 64);
        CHECK(host.stats().memory - before <= 64u * (128u * 128u * 8u + (512u << 10)));
    }
}

} // namespace gnomon::test
