// A host that never holds still: meshes come and go, views change size, positions are rewritten, recorded buffers are
// dropped, three frames are in flight. Nothing waits, nothing breaks, the pictures are those of what stands still.
#include <map>
#include <memory>
#include <tuple>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1, kBox = 2;
constexpr uint32_t kFrames = 30;

GnMesh createMesh(GnContext context, const demo::Mesh& mesh)
{
    const GnMeshCreateInfo info{.pName = mesh.name.c_str(),
                                .pPositions = &mesh.positions[0].x,
                                .positionCount = static_cast<uint32_t>(mesh.positions.size()),
                                .positionStride = 0,
                                .indexCount = static_cast<uint32_t>(mesh.indices.size()),
                                .pIndices = mesh.indices.data()};
    GnMesh handle = VK_NULL_HANDLE;
    REQUIRE(gnCreateMesh(context, &info, &handle) == GN_SUCCESS);
    return handle;
}

/// The ball of a frame: another size every time, the same vertices.
demo::Mesh ballOf(uint32_t frame)
{
    return demo::makeSphere({.radius = 0.5f + 0.01f * static_cast<float>(frame % 40), .slices = 24, .stacks = 12});
}

/// The box of a frame: another mesh altogether.
demo::Mesh boxOf(uint32_t frame)
{
    return frame % 2
               ? demo::makeTorus({.radius = 0.6f, .tube = 0.2f, .ringSegments = 16 + frame % 5, .tubeSegments = 8})
               : demo::makeBox({.size = {1.0f, 1.0f + 0.01f * static_cast<float>(frame), 1.0f}});
}

VkExtent2D extentOf(uint32_t frame)
{
    return {160 + 8 * (frame % 7), 90 + 4 * (frame % 5)};
}

/// Casters of the ball and the box, unseen by the camera, which sees the floor alone: the host need not redraw them.
Scene churnScene(const GnMethodInfo& method)
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = scene.instances[kBox].isStatic = false;
    if (servedKind(method) == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    if (servedKind(method) == demo::LightKind::Directional) scene.lights[0].kind = demo::LightKind::Directional;
    if (method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT) scene.lights[0].radius = 0.2f;
    return scene;
}

void hideCasters(Host& host)
{
    host.hide(kBall);
    host.hide(kBox);
}

/// What a frame must look like, by contexts whose casters are never touched: of each frame, one for every kind of
/// light.
class Expected {
public:
    std::vector<Image8> operator()(const GnMethodInfo& method, uint32_t frame)
    {
        Scene scene = churnScene(method);
        scene.meshes[1] = ballOf(frame);
        scene.meshes[2] = boxOf(frame);
        std::unique_ptr<Host>& still = still_[{frame, scene.lights[0].kind, scene.lights[0].radius}];
        if (!still) {
            still = std::make_unique<Host>(scene, HostOptions{.extent = extentOf(frame)});
            hideCasters(*still);
        }
        still->beginAnew(scene, method.pName);
        still->require(still->draw());
        return still->pictures();
    }

private:
    std::map<std::tuple<uint32_t, demo::LightKind, float>, std::unique_ptr<Host>> still_;
};

void churn(const GnMethodInfo& method, Expected& expected)
{
    CAPTURE(std::string(method.pName));
    Host host(churnScene(method), {.extent = extentOf(0), .framesInFlight = 3});
    hideCasters(host);
    host.pinAll(method.pName);
    GnMesh box = host.meshes[2];
    const uint32_t waitsBefore = vulkanCalls().deviceWaitIdle + vulkanCalls().queueWaitIdle;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        CAPTURE(frame);
        const demo::Mesh ball = ballOf(frame);
        host.require(gnUpdateMeshPositions(host.context, host.meshes[1], &ball.positions[0].x,
                                           static_cast<uint32_t>(ball.positions.size()), 0));
        const GnMesh next = createMesh(host.context, boxOf(frame));
        host.require(gnSetInstanceMesh(host.context, host.instances[kBox], next));
        gnDestroyMesh(host.context, box);
        box = next;
        host.resize(extentOf(frame));
        // What can be recorded is, every third frame for nothing.
        const bool recordable = method.roundTrips == 0;
        const bool drop = recordable && frame % 3 == 2;
        host.require(host.draw({.call = recordable ? Call::record : Call::submit, .drop = drop}));
        REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
        if (frame % 15 == 13) { // of every third, none of those that are dropped
            const std::vector<Image8> pictures = host.pictures();
            CHECK(dark(pictures[0]) > 50);
            CHECK(differences(pictures, expected(method, frame)) == 0);
        }
    }
    CHECK(vulkanCalls().deviceWaitIdle + vulkanCalls().queueWaitIdle == waitsBefore);
}

} // namespace

TEST_CASE_FIXTURE(
    DeviceTest,
    "30 frames of destroyed meshes, rewritten positions, new sizes and dropped buffers show the right shadows")
{
    const Host known(smallScene(), {.warmUp = false});
    Expected expected;
    for (const GnMethodInfo& method : availableMethods(known.context))
        churn(method, expected);
}

TEST_CASE_FIXTURE(DeviceTest, "nothing waits for an idle device or queue, nor does the destruction of the context")
{
    auto host = std::make_unique<Host>(churnScene({.traits = GN_TRAIT_SPOT_BIT}),
                                       HostOptions{.framesInFlight = 3, .viewCount = 2});
    const uint32_t deviceWaits = vulkanCalls().deviceWaitIdle, queueWaits = vulkanCalls().queueWaitIdle;
    const std::string rules = shippedRules("default");
    host->require(gnLoadRules(host->context, rules.data(), rules.size(), "default"));
    for (uint32_t frame = 0; frame < 30; ++frame) {
        host->scene.instances[kBall].pose.position.x += 0.02;
        if (frame == 5) host->resize({200, 120});
        if (frame == 10) gnDestroyInstance(host->context, host->instances[kBox]);
        if (frame == 15) host->pinAll("ray_traced");
        if (frame == 20) host->pinAll("stencil_volume");
        if (frame == 25) host->require(gnWarmUp(host->context));
        host->require(host->draw());
        if (frame == 10)
            host->require(gnCreateInstance(
                host->context, &*std::make_unique<GnInstanceCreateInfo>(GnInstanceCreateInfo{.mesh = host->meshes[2]}),
                &host->instances[kBox]));
    }
    CHECK(vulkanCalls().deviceWaitIdle == deviceWaits);
    CHECK(vulkanCalls().queueWaitIdle == queueWaits);
    host.reset();
    CHECK(vulkanCalls().deviceWaitIdle == deviceWaits);
    CHECK(vulkanCalls().queueWaitIdle == queueWaits);
}

TEST_CASE_FIXTURE(DeviceTest, "a destroyed view and a destroyed light are gone, the others go on")
{
    Scene scene = smallScene();
    scene.lights.push_back(spotLight("second", {-4.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
    Host host(scene, {.framesInFlight = 3});
    host.pinAll("shadow_map");
    host.draw(3, {});
    const std::vector<Image8> before = host.pictures();
    gnDestroyLight(host.context, host.lights[1]);
    CHECK(host.draw() == GN_ERROR_INVALID_HANDLE);
    CHECK(host.lastError().find("pLights[1]") != std::string::npos);
    const std::vector<GnLight> left = {host.lights[0]};
    host.require(host.draw({.lights = &left}));
    CHECK(differences(before[0], host.pictures()[0]) == 0);

    gnDestroyView(host.context, host.views[0]);
    CHECK(host.draw({.lights = &left}) == GN_ERROR_INVALID_HANDLE);
    host.require(gnCreateView(host.context, nullptr, &host.views[0]));
    host.require(host.draw({.lights = &left}));
    CHECK(differences(before[0], host.pictures()[0]) == 0);
}
