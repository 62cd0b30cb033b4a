// Frames that begin and never come to be seen, failed or dropped: what a host finds afterwards is what was drawn.
#include <utility>

#include "device/failing.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kSmall{320, 180};

HostOptions withWorkers()
{
    return {.context = [](GnContextCreateInfo& info) { info.jobThreadCount = 3; }};
}

/// One that no frame has.
GnView spareView(const Host& host)
{
    GnView view = VK_NULL_HANDLE;
    host.require(gnCreateView(host.context, nullptr, &view));
    return view;
}

/// Calls that finish a frame under way before they do their own work, which must be done all the same.
const std::pair<const char*, void (*)(Host&)> kFinishing[] = {
    {"gnDestroyView",
     [](Host& host) {
         const GnView view = spareView(host);
         gnDestroyView(host.context, view);
         GnVisibility visibility{};
         CHECK(gnGetVisibility(host.context, view, &visibility) == GN_ERROR_INVALID_HANDLE);
     }},
    {"gnWarmUp", [](Host& host) { CHECK(gnWarmUp(host.context) == GN_SUCCESS); }},
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a frame that another call finished and that failed is told by its gnFinishShadows")
{
    for (const auto& [name, call] : kFinishing) {
        CAPTURE(std::string(name));
        Thrower thrower;
        Host host(smallScene(), withWorkers());
        thrower.join(host);
        host.require(host.draw());
        thrower.throws = true;
        host.require(host.draw({.call = Call::begin}));
        call(host);
        CHECK(host.finish(0) == GN_ERROR_OUT_OF_HOST_MEMORY);
        thrower.throws = false;
        host.require(host.draw()); // with the same number
    }
    for (const auto& [name, call] : kFinishing) {
        CAPTURE(std::string(name));
        Host host(smallScene(), watched());
        host.pinAll("pcf_hybrid");
        host.require(host.draw());
        queue.failAt = 1;
        host.require(host.draw({.call = Call::begin}));
        call(host);
        CHECK(host.finish(0) == GN_ERROR_OUT_OF_HOST_MEMORY);
        CHECK(host.lastError().find("vkQueueSubmit2") != std::string::npos);
        host.require(host.draw());
        CHECK(differences(host.pictures(), fresh(smallScene(), "pcf_hybrid", kSmall)) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that another call finished well is told once, or never where nobody asks")
{
    for (const auto& [name, call] : kFinishing) {
        CAPTURE(std::string(name));
        Host host(smallScene());
        host.pinAll("pcf_hybrid");
        host.require(host.draw({.call = Call::begin}));
        call(host);
        CHECK(host.finish(0) == GN_SUCCESS);
        CHECK(gnFinishShadows(host.context, 0) == GN_ERROR_FRAME_ORDER);
        CHECK(differences(host.pictures(), fresh(smallScene(), "pcf_hybrid", kSmall)) == 0);
        host.require(host.draw());
        CHECK(gnFinishShadows(host.context, 0) == GN_ERROR_FRAME_ORDER);
    }
}
