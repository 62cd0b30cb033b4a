// Frames that begin and never come to be seen, failed or dropped: what a host finds afterwards is what was drawn.
#include <algorithm>
#include <thread>

#include "device/failing.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kSmall{320, 180}, kLarge{480, 270};

HostOptions withWorkers()
{
    return {.context = [](GnContextCreateInfo& info) { info.jobThreadCount = 3; }};
}

GnResult askVisibility(const Host& host, GnVisibility& out)
{
    return gnGetVisibility(host.context, host.views[0], &out);
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

Scene bulbScene()
{
    Scene scene = smallScene();
    scene.lights = {pointLight("bulb", {0.0, 5.0, 0.0}, true)};
    return scene;
}

/// A camera from which nothing above the bulb can be seen, or nothing below it.
demo::CameraState looking(bool up)
{
    Scene scene;
    scene.camera = {up ? demo::CameraKey{.eye = {0.0, 6.0, 6.0}, .target = {0.0, 12.0, 0.0}}
                       : demo::CameraKey{.eye = {0.0, 4.0, 6.0}, .target = {0.0, -1.0, 0.0}}};
    return demo::cameraAt(scene, 0.0);
}

uint32_t validLayers(const Host& host)
{
    GnLightMap map{};
    host.require(gnGetLightMap(host.context, host.lights[0], &map));
    return map.validLayers;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a frame that another call finished and that failed is told by its gnFinishShadows")
{
    for (const auto& [by, call] : kFinishing) {
        const std::string name = by; // clang 14 captures no structured bindings
        CAPTURE(name);
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
    for (const auto& [by, call] : kFinishing) {
        const std::string name = by; // clang 14 captures no structured bindings
        CAPTURE(name);
        Host host(smallScene(), watched());
        host.pinAll("ray_traced");
        host.require(host.draw());
        queue.failAt = 1;
        host.require(host.draw({.call = Call::begin}));
        call(host);
        CHECK(host.finish(0) == GN_ERROR_OUT_OF_HOST_MEMORY);
        CHECK(host.lastError().find("vkQueueSubmit2") != std::string::npos);
        host.require(host.draw());
        CHECK(differences(host.pictures(), fresh(smallScene(), "ray_traced", kSmall)) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that another call finished well is told once, or never where nobody asks")
{
    for (const auto& [by, call] : kFinishing) {
        const std::string name = by; // clang 14 captures no structured bindings
        CAPTURE(name);
        Host host(smallScene());
        host.pinAll("ray_traced");
        host.require(host.draw({.call = Call::begin}));
        call(host);
        CHECK(host.finish(0) == GN_SUCCESS);
        CHECK(gnFinishShadows(host.context, 0) == GN_ERROR_FRAME_ORDER);
        CHECK(differences(host.pictures(), fresh(smallScene(), "ray_traced", kSmall)) == 0);
        host.require(host.draw());
        CHECK(gnFinishShadows(host.context, 0) == GN_ERROR_FRAME_ORDER);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that was dropped or failed leaves no map of a light")
{
    Host host(smallScene(), watched());
    host.pinAll("shadow_map");
    GnLightMap map{};
    host.require(host.draw({.call = Call::record, .drop = true}));
    CHECK(gnGetLightMap(host.context, host.lights[0], &map) == GN_ERROR_UNKNOWN_METHOD);
    host.require(host.draw());
    CHECK(validLayers(host) == 1);
    queue.failAt = 0;
    CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
    CHECK(gnGetLightMap(host.context, host.lights[0], &map) == GN_ERROR_UNKNOWN_METHOD);
}

TEST_CASE_FIXTURE(DeviceTest, "layers that a failed attempt would have drawn do not count for the next one")
{
    const std::vector<demo::CameraState> down = {looking(false)}, up = {looking(true)};
    const auto only = [](const std::vector<demo::CameraState>& cameras) {
        Host host(bulbScene());
        host.pinAll("cube_map");
        host.require(host.draw({.cameras = &cameras}));
        return validLayers(host);
    };
    const uint32_t wanted = only(up);
    REQUIRE((only(down) & ~wanted) != 0); // else there is nothing to see
    Host host(bulbScene(), watched());
    host.pinAll("cube_map");
    queue.failAt = 0;
    CHECK(host.draw({.cameras = &down}) == GN_ERROR_OUT_OF_HOST_MEMORY);
    host.require(host.draw({.cameras = &up}));
    CHECK(validLayers(host) == wanted);
}

TEST_CASE_FIXTURE(DeviceTest, "a map's valid layers are those that any view of its light needs")
{
    Host host(bulbScene(), {.viewCount = 2});
    host.pinAll("cube_map");
    const auto valid = [&](bool firstUp, bool secondUp) {
        const std::vector<demo::CameraState> cameras = {looking(firstUp), looking(secondUp)};
        host.require(host.draw({.cameras = &cameras}));
        return validLayers(host);
    };
    const uint32_t down = valid(false, false), up = valid(true, true);
    CHECK(down != up);
    CHECK(valid(true, false) == (up | down));
}

TEST_CASE_FIXTURE(DeviceTest, "a view's first frame leaves no visibility where it is dropped or fails")
{
    Host host(smallScene(), watched());
    host.pinAll("shadow_map");
    GnVisibility visibility{};
    host.require(host.draw({.call = Call::record, .drop = true}));
    CHECK(askVisibility(host, visibility) == GN_ERROR_FRAME_ORDER);
    queue.failAt = 0;
    CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
    CHECK(askVisibility(host, visibility) == GN_ERROR_FRAME_ORDER);
    host.require(host.draw());
    host.require(askVisibility(host, visibility));
    CHECK(differences(host.pictures(), fresh(smallScene(), "shadow_map", kSmall)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a view whose new size nobody has seen shows the old one, under another revision")
{
    enum class End { dropped, refused, half };
    for (const End end : {End::dropped, End::refused, End::half}) {
        CAPTURE(int(end));
        Host host(smallScene(), watched());
        host.pinAll("ray_traced");
        if (end == End::dropped) host.pinAll("shadow_map"); // what can be recorded
        host.draw(3, {});
        const std::vector<Image8> before = host.pictures();
        GnVisibility old{}, now{};
        host.require(askVisibility(host, old));
        host.resize(kLarge);
        for (int attempt = 0; attempt < 3; ++attempt) {
            if (end == End::dropped) {
                host.require(host.draw({.call = Call::record, .drop = true}));
            } else {
                queue.failAt = end == End::half;
                CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
            }
            host.require(askVisibility(host, now));
            CHECK(now.image == old.image);
            CHECK(now.revision > old.revision);
            CHECK(now.extent.width == kSmall.width);
            CHECK(differences(host.pictures(), before) == 0);
        }
        host.require(host.draw());
        CHECK(differences(host.pictures(),
                          fresh(smallScene(), end == End::dropped ? "shadow_map" : "ray_traced", kLarge)) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a failed frame says whether what it waits for was waited for")
{
    Host host(smallScene(), watched());
    host.pinAll("ray_traced");
    host.draw(2, {});
    for (const uint32_t submitted : {0u, 1u, 0u}) {
        queue.failAt = submitted;
        CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
        CHECK(host.stats().frame == host.frame() + 1);
        CHECK(host.stats().submits == submitted);
        const auto nobody = [](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.pViews = nullptr; };
        CHECK(host.draw({.adjust = nobody}) == GN_ERROR_NULL_ARGUMENT);
        CHECK(host.stats().submits == 0);
    }
    Thrower thrower;
    Host other(smallScene(), withWorkers());
    thrower.join(other);
    thrower.throws = true;
    CHECK(other.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
    CHECK(other.stats().submits == 1);
}

TEST_CASE_FIXTURE(DeviceTest, "after the loss of the device each thread is told of it, and no other sentence")
{
    Host host(smallScene(), watched());
    host.pinAll("shadow_map");
    host.draw(2, {});
    queue.failAt = 0;
    queue.failure = VK_ERROR_DEVICE_LOST;
    CHECK(host.draw() == GN_ERROR_DEVICE_LOST);
    std::string told;
    GnResult result = GN_SUCCESS;
    std::thread([&] {
        GnMesh mesh = VK_NULL_HANDLE;
        const GnMeshCreateInfo info{};
        result = gnCreateMesh(host.context, &info, &mesh);
        told = gnGetLastError(host.context);
    }).join();
    CHECK(result == GN_ERROR_DEVICE_LOST);
    CHECK(told.find("lost") != std::string::npos);
}

TEST_CASE_FIXTURE(DeviceTest, "a new thread has failed at nothing, whoever had its id before")
{
    Host host(smallScene());
    std::thread([&] { CHECK(gnDropFrame(host.context, 7) == GN_ERROR_FRAME_ORDER); }).join();
    for (int i = 0; i < 10; ++i) {
        std::string told = "?";
        std::thread([&] { told = gnGetLastError(host.context); }).join();
        CHECK(told.empty());
    }
}
