// stencil_volume's setting `extents`: volumes that hold nothing anybody sees are not drawn, whatever moves, and the
// picture stays.
#include "device/draw_counter.hpp"
#include "device/method_pair.hpp"
#include "device/small_scenes.hpp"
#include "shaders/volumes/cull.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kMethod = "stencil_volume";

Scene shipped(const char* name)
{
    return demo::valueOf(demo::loadScene(name));
}

void cullByExtents(Host& host)
{
    host.require(gnSetMethodSetting(host.context, kMethod, "extents", 1.0));
}

/// The same scene without and with the setting.
struct Pair : MethodPair {
    explicit Pair(const Scene& scene, const HostOptions& options = {}) : MethodPair(kMethod, kMethod, scene, options)
    {
        cullByExtents(other);
    }
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "held against the depth image, volumes draw the same picture in every shipped scene")
{
    for (const Scene& each : smallShippedScenes()) {
        CAPTURE(each.name);
        Pair pair(each, {.maxLights = 32});
        for (const double zFail : {0.0, 1.0}) {
            pair.set("z_fail", zFail);
            for (const double time : {0.0, 0.5})
                CHECK(pair.differing({.time = time}) == 0);
        }
        CHECK(dark(pair.pictures[0]) > 100);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "they do with silhouettes of the device, in two views, and from inside of walls")
{
    Scene scene = shipped("rooms");
    demo::limitLights(scene, 2);
    const demo::CameraState inWall{.eye = {2.5, 1.2, 0.02}, .target = {2.4, 1, 4}, .verticalFov = 1.2f};
    const demo::CameraState above{.eye = {0, 20, 12}, .target = {0, 0, 0.8}, .verticalFov = 1.2f};
    const std::vector<demo::CameraState> cameras = {inWall, above};
    Pair pair(scene, {.viewCount = 2});
    for (const double onDevice : {0.0, 1.0}) {
        pair.set("silhouettes", onDevice);
        CHECK(pair.differing({.cameras = &cameras}) == 0);
        CHECK(differences(pair.plain.pictures(1), pair.other.pictures(1)) == 0);
        CHECK(pair.other.passCount("volumes.cull") > 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "under lights that move, volumes without a visible receiver are left out")
{
    if (!DrawCounter::possible()) {
        MESSAGE("no queries: nothing is checked");
        return;
    }
    Scene scene = shipped("rooms");
    demo::limitLights(scene, 4);
    for (demo::Light& light : scene.lights)
        light.isStatic = false;
    // In a room: what stands in others is seen by nobody.
    const std::vector<demo::CameraState> camera = {
        {.eye = {3.4, 1.6, 2.5}, .target = {1, 0.8, 2.4}, .verticalFov = 1.2f}};
    DrawCounter counter;
    Host all(scene, counter.options()), culled(scene, counter.options());
    all.pinAll(kMethod);
    culled.pinAll(kMethod);
    cullByExtents(culled);
    const DrawCount before = counter.count(all, {.cameras = &camera}),
                    after = counter.count(culled, {.cameras = &camera});
    MESSAGE(before.triangles << " -> " << after.triangles << " triangles, " << before.samples << " -> " << after.samples
                             << " samples");
    CHECK(before.triangles > 1000);
    CHECK(3 * after.triangles <= 2 * before.triangles);
    CHECK(after.draws == before.draws); // the device decides, no figure comes back
    CHECK(differences(all.pictures(), culled.pictures()) == 0);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "where volumes can be is worked out again for what moved, static and moving casters apart")
{
    Scene scene = smallScene();
    scene.lights = {pointLight("lamp", {0.5, 6.0, 1.0}, true)};
    for (int i = 0; i < 8; ++i) { // enough of either kind to be chosen among
        demo::Instance instance = scene.instances[1];
        instance.name = "ball" + std::to_string(i);
        instance.isStatic = i % 2 == 0;
        instance.pose.position = {i - 4.0, 1.5, -1.0};
        scene.instances.push_back(instance);
    }
    Pair pair(scene);
    CHECK(pair.differing({}) == 0);
    CHECK(pair.other.passCount("volumes.regions") == 2);
    CHECK(pair.other.passCount("volumes.cull") == 2);
    CHECK(pair.differing({}) == 0);
    CHECK(pair.other.passCount("volumes.regions") == 0);
    CHECK(pair.other.passCount("volumes.cull") == 2);
    for (Host* host : {&pair.plain, &pair.other})
        host->scene.instances.back().pose.position.z += 0.5;
    CHECK(pair.differing({}) == 0);
    CHECK(pair.other.passCount("volumes.regions") == 1);
    for (Host* host : {&pair.plain, &pair.other})
        host->scene.lights[0].position.x += 0.5;
    CHECK(pair.differing({}) == 0);
    CHECK(pair.other.passCount("volumes.regions") == 2);
}

TEST_CASE_FIXTURE(DeviceTest, "more volumes than one dispatch chooses among are chosen among all the same")
{
    Scene scene = smallScene();
    const demo::Instance box = scene.instances[2];
    for (uint32_t i = 0; i < gpu::CANDIDATES + 40; ++i) {
        demo::Instance instance = box;
        instance.name = "box" + std::to_string(i);
        instance.pose.position = {0.3 * (i % 20) - 3.0, 0.2 + 0.02 * (i % 7), 0.3 * (i / 20) - 4.0};
        instance.pose.scale = glm::dvec3(0.1);
        scene.instances.push_back(instance);
    }
    Pair pair(scene);
    for (const double zFail : {0.0, 1.0}) {
        pair.set("z_fail", zFail);
        CHECK(pair.differing({}) == 0);
        CHECK(pair.other.passCount("volumes.cull") == 1);
    }
    CHECK(dark(pair.pictures[0]) > 100);
}
