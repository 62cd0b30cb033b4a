// The example at the head of gnomon.h, on a device.
#include <doctest/doctest.h>

#include "device/fixture.hpp"
#include "gnomon_example.c"

using namespace gnomon::test;

TEST_CASE_FIXTURE(DeviceTest, "the header's example gives a sun's visibility")
{
    Host host(smallScene()); // draws the depth
    const GnContextCreateInfo info = device().contextInfo();
    REQUIRE(info.queueFamilyIndex == 0); // as the example says of its queue
    Renderer renderer{};
    renderer.instance = info.instance;
    renderer.gpu = info.physicalDevice;
    renderer.device = info.device;
    renderer.queue = info.queue;
    renderer.pFeatures = info.pEnabledFeatures;
    const float triangle[] = {-9.0f, 1.0f, -9.0f, 0.0f, 1.0f, 9.0f, 9.0f, 1.0f, -9.0f};
    REQUIRE(startShadows(&renderer, info.pfnGetInstanceProcAddr, triangle, 3) == GN_SUCCESS);

    GnViewFrame seen{};
    GnVisibility visibility{};
    host.require(host.draw({.call = Call::record,
                            .adjust = [&](GnFrameInfo&, std::vector<GnViewFrame>& views) { seen = views[0]; },
                            .around =
                                [&](VkCommandBuffer commands, bool begins) {
                                    if (!begins) return;
                                    renderer.depth = seen.depthImage;
                                    renderer.depthView = seen.depthView;
                                    renderer.size = seen.imageExtent;
                                    CHECK(recordShadows(&renderer, commands, 1, 0, seen.projection, &visibility) ==
                                          GN_SUCCESS);
                                }}));
    static_cast<void>(host.pictures()); // the device is done with the frame
    CHECK(visibility.image != VK_NULL_HANDLE);
    CHECK(visibility.layerCount >= 1);
    CHECK(visibility.extent.width == seen.imageExtent.width);
    GnDecision decision{};
    CHECK(gnGetDecision(renderer.shadows, renderer.view, renderer.sun, &decision) == GN_SUCCESS);
    CHECK(decision.pMethod != nullptr);
    gnDestroyContext(renderer.shadows);
}
