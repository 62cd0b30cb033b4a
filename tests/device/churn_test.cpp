// A host that never holds still: meshes come and go, views change size, positions are rewritten, recorded buffers are
// dropped, three frames are in flight. Nothing waits, nothing breaks, the pictures are those of a fresh context.
#include <thread>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1, kBox = 2;
constexpr uint32_t kFrames = 100;

GnMesh createMesh(GnContext context, const demo::Mesh& mesh)
{
    const GnMeshCreateInfo info{.pName = mesh.name.c_str(),
                                .pPositions = &mesh.positions[0].x,
                                .positionCount = static_cast<uint32_t>(mesh.positions.size()),
                                .positionStride = 0,
                                .pIndices = mesh.indices.data(),
                                .indexCount = static_cast<uint32_t>(mesh.indices.size())};
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

/// By rays: without a radius they are ray_traced.
bool soft(const std::string& method)
{
    return method == "coherence_sampling" || method == "eight_point_hybrid";
}

/// Casters of the ball and the box, unseen by the camera, which sees the floor alone: the host need not redraw them.
Scene churnScene(const char* method)
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = scene.instances[kBox].isStatic = false;
    const bool point = std::string(method) == "cube_map" || std::string(method) == "dual_paraboloid";
    if (point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    if (soft(method)) scene.lights[0].radius = 0.2f;
    if (std::string(method) == "cascades") scene.lights[0].kind = demo::LightKind::Directional;
    return scene;
}

void hideCasters(Host& host)
{
    host.hide(kBall);
    host.hide(kBox);
}

/// What the frame must look like, by a context that has never seen another frame.
std::vector<Image8> expected(const char* method, uint32_t frame)
{
    Scene scene = churnScene(method);
    scene.meshes[1] = ballOf(frame);
    scene.meshes[2] = boxOf(frame);
    Host fresh(scene, {.extent = extentOf(frame)});
    hideCasters(fresh);
    fresh.pinAll(method);
    fresh.require(fresh.draw());
    return fresh.pictures();
}

void churn(const char* method)
{
    CAPTURE(std::string(method));
    Host host(churnScene(method), {.extent = extentOf(0), .framesInFlight = 3});
    hideCasters(host);
    host.pinAll(method);
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
        // Rays need the CPU, so those frames cannot be recorded; the others are, every third of them for nothing.
        const bool recordable = std::string(method) != "ray_traced" && std::string(method) != "pcf_hybrid" &&
                                std::string(method) != "angular_spans" && std::string(method) != "contour_chain" &&
                                std::string(method) != "tile_shafts" && !soft(method) &&
                                std::string(method).rfind("conservative_map", 0) != 0;
        const bool drop = recordable && frame % 3 == 2;
        host.require(host.draw({.call = recordable ? Call::record : Call::submit, .drop = drop}));
        REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
        if (!drop && frame % 50 == 49) {
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
    "100 frames of destroyed meshes, rewritten positions, new sizes and dropped buffers show the right shadows")
{
    for (const char* method : {"shadow_map",
                               "cube_map",
                               "dual_paraboloid",
                               "rbsm",
                               "cascades",
                               "stencil_volume",
                               "octree_volume",
                               "all_edges_volume",
                               "projected_planar",
                               "chan_durand",
                               "mccool",
                               "pcf_hybrid",
                               "ray_traced",
                               "angular_spans",
                               "contour_chain",
                               "conservative_map",
                               "conservative_map_adjacency",
                               "tile_shafts",
                               "penumbra_wedges",
                               "coherence_sampling",
                               "eight_point_hybrid"})
        churn(method);
}

TEST_CASE_FIXTURE(DeviceTest, "nothing waits for an idle device or queue, nor does the destruction of the context")
{
    auto host = std::make_unique<Host>(churnScene("shadow_map"), HostOptions{.framesInFlight = 3, .viewCount = 2});
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
