// Thousands of frames of moving casters and a moving light under all volume methods at once: what is held after the
// first second is what is held at the end. Without validation: the layer allocates in every call.
#include <cmath>
#include <cstdlib>

#include "device/fixture.hpp"
#include "runtime/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

// A leak of one allocation every 30 frames shows; the row `full` of tests/matrix.sh draws ten thousand.
const uint32_t kFrames = std::getenv("GNOMON_TEST_FULL") ? 10000 : 3000;
// Rings, pools and lists have had their largest size: several times around, two timed frames (one in eight) in every
// slot, and more than the 60 frames after which what is not used is given back.
constexpr uint32_t kWarmFrames = 240;
constexpr uint32_t kPeriod = 48;
constexpr const char* kMethods[] = {"stencil_volume", "octree_volume", "chan_durand",      "all_edges_volume",
                                    "mccool",         "angular_spans", "projected_planar", "penumbra_wedges"};

[[maybe_unused]] const bool unvalidated = (withoutValidation(), true);

/// A light per method, the first of which moves; a ring passes between it and the eye, so that z-fail comes and goes.
Scene movingScene()
{
    Scene scene = smallScene();
    scene.meshes[1] = demo::makeTorus({.radius = 0.6f, .tube = 0.25f, .ringSegments = 12, .tubeSegments = 8});
    scene.meshes.push_back(demo::makePlane({.width = 1.2f, .depth = 1.2f, .columns = 3, .rows = 3}));
    scene.instances[1].isStatic = false;
    demo::Instance sheet = scene.instances[1];
    sheet.name = "sheet";
    sheet.mesh = 3;
    scene.instances.push_back(sheet);
    scene.lights = {spotLight("moving", {3.0, 8.0, 8.5}, {0.0, 0.0, 0.0}, false),
                    spotLight("still", {-4.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true),
                    spotLight("mapped", {4.0, 6.0, -3.0}, {0.0, 0.0, 0.0}, true),
                    spotLight("all edges", {-3.0, 7.0, -2.0}, {0.0, 0.0, 0.0}, true),
                    spotLight("toggled", {2.0, 7.0, -4.0}, {0.0, 0.0, 0.0}, true),
                    spotLight("spans", {-2.0, 6.5, 3.0}, {0.0, 0.0, 0.0}, true),
                    spotLight("planar", {3.5, 6.5, 1.0}, {0.0, 0.0, 0.0}, true),
                    spotLight("wide", {-1.0, 7.5, 2.0}, {0.0, 0.0, 0.0}, true)};
    for (demo::Light& light : scene.lights)
        light.outerAngle = 1.0f;
    scene.lights.back().radius = 0.2f;
    REQUIRE(scene.lights.size() == std::size(kMethods));
    return scene;
}

void move(Host& host, uint32_t frame)
{
    const double turn = 6.283185307179586 * (frame % kPeriod) / kPeriod;
    const glm::dvec3 low{-1.5, 1.6, 0.5}, beforeEye{1.5, 7.0, 8.2};
    host.scene.instances[1].pose.position = low + (0.5 - 0.5 * std::cos(turn)) * (beforeEye - low);
    host.scene.instances[3].pose.position = {1.0, 1.5, std::cos(turn)};
    host.scene.lights[0].position.x = 3.0 + std::sin(turn);
}

} // namespace

TEST_CASE("thousands of frames of moving casters leave nothing behind")
{
    Host host(movingScene(), {.extent = {48, 32}});
    for (size_t light = 0; light < std::size(kMethods); ++light)
        host.pin(light, kMethods[light]);
    // Of 2048 pixels a map needs few; a map of 1024, drawn in every frame, would be all that takes time.
    for (const char* method : {"mccool", "chan_durand"})
        host.require(gnSetMethodSetting(host.context, method, "resolution", 128.0));
    uint32_t objects = 0, lists = 0, fewest = UINT32_MAX, most = 0;
    size_t heap = 0;
    VkDeviceSize least = ~VkDeviceSize{0}, largest = 0;
    int64_t liveBefore = 0;
    for (uint32_t frame = 0; frame < kWarmFrames + kFrames; ++frame) {
        if (frame == kWarmFrames) liveBefore = liveAllocationCount();
        move(host, frame);
        host.require(host.draw({.counter = &allocationCount}));
        if (frame < kWarmFrames) continue;
        const GnFrameStats stats = host.stats();
        heap += host.counted;
        objects += stats.deviceAllocations;
        lists += stats.indexListsBuilt;
        fewest = std::min(fewest, stats.indexListsBuilt);
        most = std::max(most, stats.indexListsBuilt);
        least = std::min(least, stats.memory);
        largest = std::max(largest, stats.memory);
    }
    for (size_t light = 0; light < std::size(kMethods); ++light)
        CHECK(std::string(host.decision(light).pMethod) == kMethods[light]);
    MESSAGE(lists << " index lists in " << kFrames << " frames, " << fewest << " to " << most << " a frame; " << largest
                  << " device bytes; live host allocations " << liveBefore << " -> " << liveAllocationCount());
    CHECK(fewest >= 4);   // all casters of the moving light, at least
    CHECK(most > fewest); // caps come and go
    CHECK(objects == 0);
    CHECK(least == largest);
    if (countsOnlyOurs()) {
        // Embree allocates when the tree over the instances, which angular_spans asks of open meshes, is committed
        // again. Frames with one allocation more have been seen, 3 in 10 000, and why is not known: not one a frame.
        CHECK(heap <= kFrames + kFrames / 100);
        // The host's own lists of this frame.
        CHECK(std::abs(liveAllocationCount() - liveBefore) < 100);
    }
}
