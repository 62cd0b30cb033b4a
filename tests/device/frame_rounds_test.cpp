// Many lights, many methods, several views: the round trips are those of one light, and what views or lights share is
// done once.
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

Scene roomWithSixteenLights()
{
    Scene scene = demo::valueOf(demo::loadScene("room"));
    demo::limitLights(scene, 16);
    return scene;
}

/// Every method in turn over the lights it serves. \return the names in use.
std::set<std::string> pinInTurn(Host& host, size_t lights)
{
    const std::vector<GnMethodInfo> methods = availableMethods(host.context);
    size_t step = 5; // through all families, which stand together, and in the end through every method
    while (std::gcd(step, methods.size()) != 1)
        ++step;
    std::set<std::string> used;
    std::map<demo::LightKind, size_t> next;
    for (size_t i = 0; i < lights; ++i) {
        const demo::LightKind kind = host.scene.lights[i].kind;
        const GnMethodInfo* method = nullptr;
        while (!method) {
            const GnMethodInfo& candidate = methods[step * next[kind]++ % methods.size()];
            if (serves(candidate, kind)) method = &candidate;
        }
        host.pin(i, method->pName);
        used.insert(method->pName);
    }
    return used;
}

std::vector<demo::CameraState> twoCameras(const Scene& scene)
{
    std::vector<demo::CameraState> cameras(2, demo::cameraAt(scene, 0.0));
    cameras[1].eye.x += 1.0;
    cameras[1].eye.y -= 0.5;
    return cameras;
}

struct PassCounts {
    using Key = std::pair<std::string, std::ptrdiff_t>; ///< Name, light or view.
    std::map<Key, int> perLight, perView, perTask;
};

/// Of lights without a surface: a method of penumbrae has nothing to ask more than once there.
uint32_t largestRoundTrips(Host& host, const std::set<std::string>& used)
{
    uint32_t trips = 0;
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        if (!used.contains(method.pName)) continue;
        const bool soft = (method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT) != 0;
        trips = std::max(trips, soft ? std::min(method.roundTrips, 1u) : method.roundTrips);
    }
    return trips;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "16 lights with every method in two views cost the round trips of one light")
{
    Host host(roomWithSixteenLights(), {.viewCount = 2});
    const std::set<std::string> used = pinInTurn(host, 16);
    REQUIRE(used.size() >= 4);
    const std::vector<demo::CameraState> cameras = twoCameras(host.scene);
    const uint32_t rounds = 1 + largestRoundTrips(host, used);
    for (int frame = 0; frame < 3; ++frame) {
        const uint32_t submitsBefore = vulkanCalls().submits;
        host.require(host.draw({.cameras = &cameras}));
        const GnFrameStats stats = host.stats();
        CHECK(stats.rounds == rounds);
        CHECK(stats.submits == rounds);
        CHECK(vulkanCalls().submits - submitsBefore == rounds); // what it says is what it did
        CHECK(stats.hostWaits == rounds - 1);
        for (size_t light = 0; light < 16; ++light)
            for (uint32_t view = 0; view < 2; ++view)
                CHECK(host.decision(light, view).reason == GN_REASON_PINNED);
    }
    for (uint32_t view = 0; view < 2; ++view)
        for (const Image8& picture : host.pictures(view))
            CHECK(dark(picture) > 100);
}

TEST_CASE_FIXTURE(DeviceTest, "what a light needs is done once for two views, what a view needs once for 16 lights")
{
    // Both views look the same way: then no light has more to do for two of them.
    // Where memory is short a second view's maps do not keep static casters apart.
    const auto roomy = [](GnContextCreateInfo& info) { info.memoryLimit = VkDeviceSize{8} << 30; };
    Host one(roomWithSixteenLights(), {.viewCount = 1, .context = roomy}),
        two(roomWithSixteenLights(), {.viewCount = 2, .context = roomy});
    pinInTurn(one, 16);
    pinInTurn(two, 16);
    one.require(one.draw());
    two.require(two.draw());

    const auto count = [](const Host& host) {
        PassCounts counts;
        for (const GnPassTiming& pass : host.passes()) {
            const auto light = std::find(host.lights.begin(), host.lights.end(), pass.light) - host.lights.begin();
            if (pass.light && pass.view)
                ++counts.perTask[{pass.pName, light}];
            else if (pass.light)
                ++counts.perLight[{pass.pName, light}];
            else if (pass.view)
                ++counts.perView[{pass.pName, pass.view == host.views[0] ? 0 : 1}];
        }
        return counts;
    };
    PassCounts ofOne = count(one);
    const PassCounts ofTwo = count(two);
    CHECK(ofTwo.perLight == ofOne.perLight);
    CHECK(ofTwo.perLight.size() >= 8); // eight lights and more have maps or volumes of their own
    for (auto& [key, passes] : ofOne.perTask)
        passes *= 2;
    CHECK(ofTwo.perTask == ofOne.perTask);
    CHECK(ofTwo.perTask.size() >= 16); // every light is resolved
    CHECK(ofTwo.perView.size() == 2 * ofOne.perView.size());
    CHECK(ofTwo.perView.size() >= 4);       // depth read back for rays, depth and stencil for volumes
    for (const auto& entry : ofTwo.perView) // no structured binding: clang 14 captures none in CHECK_MESSAGE's lambda
        CHECK_MESSAGE(entry.second == 1, entry.first.first);
    CHECK(differences(one.pictures(0), two.pictures(0)) == 0);
    CHECK(differences(one.pictures(0), two.pictures(1)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame without lights or views is nothing to do, not an error")
{
    Host host(smallScene());
    const std::vector<GnLight> none;
    CHECK(host.draw({.lights = &none}) == GN_SUCCESS);
    CHECK(host.stats().rounds == 1);
    CHECK(host.draw({.adjust = [](GnFrameInfo& frame, std::vector<GnViewFrame>&) {
        frame.viewCount = 0;
        frame.pViews = nullptr;
    }}) == GN_SUCCESS);
    host.require(host.draw());
    CHECK(dark(host.pictures()[0]) > 100);
}

TEST_CASE_FIXTURE(DeviceTest, "views may share their images: one samples them, another copies them")
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("bulb", {1.0, 5.0, 2.0}, true));
    for (demo::Light& light : scene.lights)
        light.isStatic = true;
    Host host(scene, {.extent = {160, 90}, .viewCount = 2});
    host.pin(0, "shadow_map"); // once its map is kept it samples depth first thing,
    host.pin(1, "ray_traced"); // as this one copies it
    const auto share = [&](GnFrameInfo&, std::vector<GnViewFrame>& views) {
        views[1].depthImage = views[0].depthImage;
        views[1].depthView = views[0].depthView;
        views[1].normalImage = views[0].normalImage;
        views[1].normalView = views[0].normalView;
        views[0].lightCount = 1;
        views[1].lightCount = 1;
        views[1].pLights = &host.lights[1];
    };
    const std::vector<demo::CameraState> cameras(2, demo::cameraAt(scene, 0.0));
    const auto picture = [&](uint32_t view) { return host.pictures(view)[0]; };
    const FrameOptions shared{.cameras = &cameras, .adjust = share};
    host.draw(3, shared);
    const demo::Image8 mapped = picture(0), traced = picture(1);

    // Alone, each shows the same.
    host.draw(2, {.cameras = &cameras});
    CHECK(host.pictures(0)[0].texels == mapped.texels);
    CHECK(host.pictures(0)[1].texels == traced.texels);

    // But not through different image views: a layout belongs to an image.
    const auto apart = [&](GnFrameInfo& info, std::vector<GnViewFrame>& views) {
        const VkImageView other = views[1].depthView;
        share(info, views);
        views[1].depthView = other;
    };
    CHECK(host.draw({.cameras = &cameras, .adjust = apart}) == GN_ERROR_OUT_OF_RANGE);
    CHECK(host.lastError().find("depthImage") != std::string::npos);
    CHECK(host.draw(shared) >= 0);
}
