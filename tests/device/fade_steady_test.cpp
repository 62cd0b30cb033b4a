// What a fade leaves behind: nothing that a steady frame would notice. Without validation: the layer allocates too.
#include "device/fade_support.hpp"
#include "runtime/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::test;

TEST_CASE("frames after a fade allocate nothing, and the next fade makes no images of its own")
{
    FadeHost host;
    favour(host, "shadow_map");
    host.draw(40, {}); // rings, pools and lists reach their final size, as in frame_steady_test.cpp
    uint32_t made = 0;
    for (int fade = 0; fade < 4; ++fade) {
        CAPTURE(fade);
        favour(host, fade % 2 ? "shadow_map" : "stencil_volume");
        for (uint32_t frame = 1; frame <= kFadeFrames; ++frame) {
            host.require(host.draw());
            CHECK(host.stats().fading == 1);
            made += host.stats().deviceAllocations;
        }
        if (fade == 0) CHECK(made > 0); // the image that both write
        if (fade == 1) made = 0;        // timed frames inside of fades have been seen
        size_t heap = 0;
        uint32_t objects = 0;
        for (uint32_t frame = 0; frame < 20; ++frame) {
            host.require(host.draw({.counter = &allocationCount}));
            CHECK(host.passCount("view.fade") == 0);
            if (fade < 2) continue;
            heap += host.counted;
            objects += host.stats().deviceAllocations;
        }
        if (countsOnlyOurs()) CHECK(heap == 0);
        CHECK(objects == 0);
    }
    CHECK(made == 0); // the later fades used what the first had made
}
