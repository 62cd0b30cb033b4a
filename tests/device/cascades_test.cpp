// Maps of slices of the view: whose they are, and when they are drawn.
#include <algorithm>

#include "device/posts.hpp"

namespace gnomon::test {
namespace {

using demo::CameraState;

uint32_t slicesDrawn(const Host& host)
{
    uint32_t count = 0;
    for (const char* name : {"cascades.casters.0", "cascades.casters.1", "cascades.casters.2"})
        count += host.passCount(name);
    return count;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "a slice of the view is drawn again when the camera has left its map, that of all casters never")
{
    Host host(land());
    host.pinAll("cascades");
    std::vector<CameraState> cameras{walked(host.scene, 0.0)};
    host.require(host.draw({.cameras = &cameras}));
    const uint32_t slices = slicesDrawn(host);
    CHECK(slices >= 2);
    CHECK(host.passCount("cascades.casters.3") == 1);
    host.require(host.draw({.cameras = &cameras}));
    CHECK(slicesDrawn(host) == 0);
    CHECK(host.stats().passesKept > 0);

    uint32_t drawn = 0, framesThatDraw = 0;
    for (int frame = 1; frame <= 100; ++frame) { // 5 m
        cameras[0] = walked(host.scene, 0.05 * frame);
        host.require(host.draw({.cameras = &cameras}));
        CHECK(host.passCount("cascades.casters.3") == 0);
        drawn += slicesDrawn(host);
        framesThatDraw += slicesDrawn(host) > 0;
    }
    CHECK(drawn > 0);
    CHECK(framesThatDraw <= 20);
}

TEST_CASE_FIXTURE(DeviceTest, "every view has slices of its own")
{
    const Scene scene = land();
    const std::vector<CameraState> cameras{walked(scene, 0.0), walked(scene, 6.0)};
    Host both(scene, {.viewCount = 2});
    both.pinAll("cascades");
    for (int frame = 0; frame < 2; ++frame)
        both.require(both.draw({.cameras = &cameras}));
    CHECK(slicesDrawn(both) == 0);
    for (uint32_t view = 0; view < 2; ++view) {
        CAPTURE(view);
        const std::vector<CameraState> one{cameras[view]};
        Host alone(scene);
        alone.pinAll("cascades");
        alone.require(alone.draw({.cameras = &one}));
        const std::vector<Image8> pictures = both.pictures(view);
        CHECK(pictures[0].texels == alone.pictures()[0].texels);
        CHECK(std::count(pictures[0].texels.begin(), pictures[0].texels.end(), uint8_t{0}) > 50);
    }
}

} // namespace gnomon::test
