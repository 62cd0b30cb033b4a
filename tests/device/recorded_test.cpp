// gnCmdRenderShadows: the same pictures as gnSubmitShadows, from the host's own command buffer.
#include "device/fixture.hpp"
#include "device/small_scenes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// The lights of the time that the method serves, pinned to it.
std::vector<GnLight> pinServed(Host& host, const GnMethodInfo& method, double time)
{
    std::vector<GnLight> served;
    for (const uint32_t light : demo::stateAt(host.scene, time).present) {
        if (!serves(method, host.scene.lights[light].kind)) continue;
        host.pin(light, method.pName);
        served.push_back(host.lights[light]);
    }
    return served;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "a recorded frame shows what a submitted one shows, for every method that can be recorded")
{
    std::vector<std::string> pairs;
    size_t turn = 0; // every method in half of the scenes, one half in the first
    for (const Scene& scene : smallShippedScenes()) {
        Host submitted(scene, {.maxLights = 32}), recorded(scene, {.maxLights = 32});
        const std::vector<GnMethodInfo> methods = availableMethods(submitted.context);
        turn += methods.size() % 2 == 0; // the other half in the next scene
        for (const GnMethodInfo& method : methods) {
            if (turn++ % 2 == 0 || method.roundTrips != 0) continue;
            CAPTURE(scene.name);
            CAPTURE(std::string(method.pName));
            // Two times: what moved in between is drawn over what was kept.
            for (const double time : {0.0, 0.5}) {
                const std::vector<GnLight> lightsA = pinServed(submitted, method, time);
                const std::vector<GnLight> lightsB = pinServed(recorded, method, time);
                if (lightsA.empty()) continue;
                submitted.require(submitted.draw({.time = time, .lights = &lightsA}));
                recorded.require(recorded.draw({.call = Call::record, .time = time, .lights = &lightsB}));
                CHECK(recorded.stats().submits == 0);
                CHECK(recorded.stats().hostWaits == 0);
                const std::vector<Image8> pictures = submitted.pictures();
                CHECK(dark(pictures[0]) > 100);
                CHECK(differences(pictures, recorded.pictures()) == 0);
                pairs.push_back(scene.name + " " + method.pName);
            }
        }
    }
    CHECK(pairs.size() >= 4 * 10); // every scene has lights for at least three of the methods
}

TEST_CASE_FIXTURE(DeviceTest, "methods that need the CPU between passes are not eligible when recorded, and say so")
{
    Host host(smallScene());
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        CAPTURE(std::string(method.pName));
        if (method.roundTrips == 0 || !serves(method, demo::LightKind::Spot)) continue;
        host.pinAll(method.pName);
        host.require(host.draw({.call = Call::record}));
        const GnDecision decision = host.decision(0);
        REQUIRE(decision.pMethod);
        CHECK(std::string(decision.pMethod) != method.pName);
        CHECK(decision.reason != GN_REASON_PINNED);
        CHECK(host.explanation(0).find(std::string(method.pName) + ": out, needs the CPU between passes (" +
                                       std::to_string(method.roundTrips) +
                                       " round trips), but the frame is recorded") != std::string::npos);
        CHECK(dark(host.pictures()[0]) > 100); // by what served instead
        host.require(host.draw());
        CHECK(host.decision(0).reason == GN_REASON_PINNED);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a dropped frame leaves no trace: what it would have drawn is drawn by the next")
{
    Scene scene = smallScene();
    scene.instances[1].isStatic = false;
    Host host(scene), fresh(scene);
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        if (method.roundTrips != 0 || !serves(method, demo::LightKind::Spot)) continue;
        const char* name = method.pName;
        CAPTURE(std::string(name));
        for (Host* each : {&host, &fresh})
            each->beginAnew(scene, name);
        host.require(host.draw({.call = Call::record, .drop = true})); // the light's first: nothing was drawn for it
        host.require(host.draw({.call = Call::record}));
        fresh.require(fresh.draw());
        CHECK(differences(host.pictures(), fresh.pictures()) == 0);

        for (Host* each : {&host, &fresh})
            each->scene.instances[1].pose.position.x += 0.5;
        host.require(host.draw({.call = Call::record, .drop = true}));
        host.require(host.draw({.call = Call::submit}));
        fresh.require(fresh.draw());
        CHECK(differences(host.pictures(), fresh.pictures()) == 0);
        CHECK(dark(host.pictures()[0]) > 100);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "only the frame recorded last can be dropped, and only once")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    CHECK(gnDropFrame(host.context, 1) == GN_ERROR_FRAME_ORDER);
    host.require(host.draw({.call = Call::submit}));
    CHECK(gnDropFrame(host.context, host.frame()) == GN_ERROR_FRAME_ORDER); // it was submitted
    host.require(host.draw({.call = Call::record, .drop = true}));
    CHECK(gnDropFrame(host.context, host.frame()) == GN_ERROR_FRAME_ORDER);
    CHECK(host.lastError().find(std::to_string(host.frame())) != std::string::npos);
    CHECK(gnCmdRenderShadows(host.context, VK_NULL_HANDLE, nullptr) == GN_ERROR_NULL_ARGUMENT);
    const auto waits = [](GnFrameInfo& frame, std::vector<GnViewFrame>&) {
        static const GnSemaphorePoint point{};
        frame.waitCount = 1;
        frame.pWaits = &point;
    };
    CHECK(host.draw({.call = Call::record, .adjust = waits}) == GN_ERROR_OUT_OF_RANGE);
    host.require(host.draw());
    CHECK(dark(host.pictures()[0]) > 100);
}
