// ray_soft from frame to frame: what its history survives, when it is held back, and what it takes of memory.
#include "algorithms/entries.hpp"
#include "device/memory_books.hpp"

#include <algorithm>

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1;
constexpr const char* kSoft = "ray_soft";

Scene wideLight()
{
    Scene scene = smallScene();
    scene.lights[0].radius = 0.4f;
    scene.instances[kBall].isStatic = false;
    return scene;
}

/// Tests of the method end here on devices without.
bool canTrace()
{
    return tracesRays(Host(smallScene(), {.warmUp = false}).context);
}

std::vector<Image8> drawn(Host& host, uint32_t frames, const FrameOptions& options = {})
{
    host.pinAll(kSoft);
    host.draw(frames, options);
    REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
    return host.pictures();
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "a dropped frame leaves the history as it was, and recorded frames show what submitted do")
{
    if (!canTrace()) return;
    const FrameOptions record{.call = Call::record};
    Host dropping(wideLight()), plain(wideLight());
    const std::vector<Image8> third = drawn(plain, 3);
    dropping.pinAll(kSoft);
    dropping.require(dropping.draw({.call = Call::record, .drop = true})); // the first of all
    drawn(dropping, 2, record);
    dropping.require(dropping.draw({.call = Call::record, .drop = true}));
    CHECK(differences(drawn(dropping, 1, record), third) == 0);
    for (Host* host : {&dropping, &plain})
        host->scene.instances[kBall].pose.position.x += 0.2;
    dropping.require(dropping.draw({.call = Call::record, .drop = true}));
    const std::vector<Image8> moved = drawn(plain, 1);
    CHECK(differences(drawn(dropping, 1, record), moved) == 0);
    CHECK(differences(moved, third) > 50);
}

TEST_CASE_FIXTURE(DeviceTest, "the past is held back where something moves, and only there it costs a pass")
{
    if (!canTrace()) return;
    Host host(wideLight());
    drawn(host, 2);
    CHECK(host.passCount("ray_soft.accumulate") == 1);
    CHECK(host.passCount("ray_soft.blur_now") == 0);
    host.scene.instances[kBall].pose.position.x += 0.2;
    drawn(host, 1);
    CHECK(host.passCount("ray_soft.blur_now") == 1);
    drawn(host, 1);
    CHECK(host.passCount("ray_soft.blur_now") == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a view of another size, or after a cut, begins anew")
{
    if (!canTrace()) return;
    Host host(wideLight()), fresh(wideLight());
    const std::vector<Image8> first = drawn(fresh, 1);
    drawn(host, 3);
    const FrameOptions cut{.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].cameraCut = 1; }};
    CHECK(differences(drawn(host, 1, cut), first) == 0);
    CHECK(differences(drawn(host, 1), first) > 50); // which is no first frame
    host.resize({200, 120});
    fresh.resize({200, 120});
    CHECK(differences(drawn(host, 1), drawn(fresh, 1)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "memory is what the plan is told")
{
    if (!canTrace()) return;
    MemoryBooks books;
    Host host(wideLight(), books.options({.extent = {256, 128}})); // whole tiles of every device
    drawn(host, 3);
    const VkDeviceSize held = books.held("ray_soft.").bytes;
    if (held == 0) return; // without validation nothing has a name
    CAPTURE(books.list());
    const VkDeviceSize told = kRaySoft.memoryFor(std::vector<double>{1.0, 256.0}, host.extent(), GN_LIGHT_TYPE_SPOT);
    CHECK(held <= told);
    CHECK(held >= told - told / 50);
}
