// Three hundred lights of every kind in three views at once, each of which sees its own share of them, while lights,
// views and meshes go and come, and views change size, with frames in flight.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kLights = 300, kMost = 256; // of one view
constexpr VkExtent2D kExtent{64, 36};
constexpr size_t kBox = 2;

/// Points, spots and suns in turn, on a spiral round the casters.
Scene crowd()
{
    Scene scene = smallScene();
    scene.lights.clear();
    for (size_t i = 0; i < kLights; ++i) {
        const double turn = 2.4 * double(i), out = 1.0 + 0.015 * double(i);
        const glm::dvec3 at(out * std::cos(turn), 3.0 + 0.01 * double(i), out * std::sin(turn));
        const std::string name = "light" + std::to_string(i);
        demo::Light light =
            i % 3 == 0 ? pointLight(name.c_str(), at, true) : spotLight(name.c_str(), at, {0.0, 0.0, 0.0}, true);
        if (i % 3 == 2) {
            light.kind = demo::LightKind::Directional;
            light.range = 0.0f;
        }
        scene.lights.push_back(light);
    }
    return scene;
}

/// A view's share of the lights.
std::vector<GnLight> shareOf(const Host& host, size_t view)
{
    std::vector<GnLight> share;
    for (size_t i = 0; i < kLights; ++i)
        if (view == 0 ? i < kMost : view == 1 ? i >= kLights - kMost : i % 2 == 0) share.push_back(host.lights[i]);
    return share;
}

void drawShares(Host& host, Call call)
{
    const std::vector<GnLight> shares[] = {shareOf(host, 0), shareOf(host, 1), shareOf(host, 2)};
    host.require(
        host.draw({.call = call, .lights = &shares[0], .adjust = [&](GnFrameInfo&, std::vector<GnViewFrame>& views) {
                       for (size_t v = 0; v < views.size(); ++v) {
                           views[v].lightCount = static_cast<uint32_t>(shares[v].size());
                           views[v].pLights = shares[v].data();
                       }
                   }}));
}

/// Of all views, those of the lights that each has.
std::vector<Image8> sharesSeen(Host& host)
{
    std::vector<Image8> all;
    for (uint32_t view = 0; view < 3; ++view) {
        std::vector<Image8> pictures = host.pictures(view);
        pictures.resize(shareOf(host, view).size());
        std::ranges::move(pictures, std::back_inserter(all));
    }
    return all;
}

/// What a host with a world of its own does between frames, none of which it has waited for.
void comeAndGo(Host& host, const demo::Mesh& box, const char* method)
{
    for (size_t i = 0; i < kLights; i += 7) {
        gnDestroyLight(host.context, host.lights[i]);
        const GnLightInfo info = demo::toGnLight(host.scene.lights[i], demo::lightAt(host.scene.lights[i], 0.0));
        host.require(gnCreateLight(host.context, &info, &host.lights[i]));
        host.pin(i, method);
    }
    gnDestroyView(host.context, host.views[2]);
    const GnViewCreateInfo view{.maxLights = kMost};
    host.require(gnCreateView(host.context, &view, &host.views[2]));
    const GnMeshCreateInfo info{.pName = "box",
                                .pPositions = &box.positions[0].x,
                                .positionCount = static_cast<uint32_t>(box.positions.size()),
                                .indexCount = static_cast<uint32_t>(box.indices.size()),
                                .pIndices = box.indices.data()};
    GnMesh next = VK_NULL_HANDLE;
    host.require(gnCreateMesh(host.context, &info, &next));
    host.require(gnSetInstanceMesh(host.context, host.instances[kBox], next));
    gnDestroyMesh(host.context, host.meshes[kBox]);
    host.meshes[kBox] = next;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "three hundred lights in three views are right while lights, views and meshes go and come")
{
    const HostOptions options{.extent = kExtent, .framesInFlight = 3, .viewCount = 3, .maxLights = kMost};
    Host traced(crowd(), options);
    traced.pinAll("ray_traced");
    drawShares(traced, Call::submit);
    const std::vector<Image8> truth = sharesSeen(traced);
    size_t darkest = 0, pixels = 0;
    for (const Image8& picture : truth) {
        darkest += dark(picture);
        pixels += picture.texels.size();
    }
    CHECK(darkest > pixels / 50);
    for (const Call call : {Call::submit, Call::record}) {
        CAPTURE(static_cast<int>(call));
        Host host(crowd(), options);
        const char* method = "octree_volume";
        host.pinAll(method);
        for (uint32_t frame = 0; frame < 4; ++frame) {
            host.resize({kExtent.width + 8 * (3 - frame), kExtent.height});
            drawShares(host, call);
            if (frame < 3) comeAndGo(host, host.scene.meshes[kBox], method);
        }
        for (size_t i = 0; i < shareOf(host, 1).size(); ++i)
            REQUIRE(std::string(host.decision(i).pMethod) == method);
        const size_t wrong = differences(truth, sharesSeen(host));
        MESSAGE("of " << pixels << " pixels " << darkest << " dark, wrong " << wrong);
        CHECK(wrong < pixels / 1000);
    }
}
