// Frames that fail half-way: for memory, at a submit, in a host pass. The next attempt is as if nothing had been.
#include <algorithm>
#include <utility>

#include "device/failing.hpp"
#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkDeviceSize kMiB = 1u << 20;

HostOptions limited(VkDeviceSize limit, uint32_t framesInFlight = 2)
{
    return {.framesInFlight = framesInFlight, .mapSide = 1024.0, .context = [limit](GnContextCreateInfo& info) {
                info.memoryLimit = limit;
            }};
}

/// The least limit under which a view of that size and the map of its light find room, by steps of 4 MiB. How much more
/// than the texels that is, devices decide: by how they pad images, and into how many kinds of memory buffers go.
VkDeviceSize leastLimit(VkExtent2D extent)
{
    for (VkDeviceSize limit = 32 * kMiB; limit < 256 * kMiB; limit += 4 * kMiB) {
        Host host(smallScene(), limited(limit));
        host.pinAll("shadow_map");
        host.resize(extent);
        if (host.draw() == GN_SUCCESS && host.decision(0).reason == GN_REASON_PINNED) return limit;
    }
    return 0;
}

/// Visibility of 1 GiB.
void huge(GnFrameInfo&, std::vector<GnViewFrame>& views)
{
    views[0].imageExtent = {8192, 8192};
}

bool noCompute = false; ///< No pipeline of that kind is made any more.

VKAPI_ATTR VkResult VKAPI_CALL computeOrNot(VkDevice handle, VkPipelineCache cache, uint32_t count,
                                            const VkComputePipelineCreateInfo* infos,
                                            const VkAllocationCallbacks* allocator, VkPipeline* pipelines)
{
    if (noCompute) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return vkCreateComputePipelines(handle, cache, count, infos, allocator, pipelines);
}

bool anySays(const std::vector<std::string>& messages, const char* words)
{
    return std::any_of(messages.begin(), messages.end(),
                       [words](const std::string& message) { return message.find(words) != std::string::npos; });
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "frames go on without pipelines that cannot be made, and it is said once of whose they were")
{
    for (const bool warmUp : {false, true}) {
        CAPTURE(warmUp);
        HostOptions base;
        base.warmUp = false;
        Host host(smallScene(), hooked(std::move(base), {hook("vkCreateComputePipelines", &computeOrNot)}));
        const std::string rules = shippedRules("default");
        host.require(gnLoadRules(host.context, rules.data(), rules.size(), "default"));
        noCompute = true;
        if (warmUp) host.require(gnWarmUp(host.context));
        const auto methods = static_cast<uint32_t>(availableMethods(host.context).size());
        host.draw(2 * methods, {});
        CHECK(host.passCount("view.depth_grid") == 0);
        CHECK_FALSE(host.decision(0).viewerDistanceMeasured);
        CHECK(dark(host.pictures()[0]) > 100);
        const std::vector<std::string> messages = host.takeMessages();
        CHECK(anySays(messages, "distances to receivers are not measured"));
        CHECK(anySays(messages, "method 'stencil_volume': ")); // its tiles
        CHECK(gnWarmUpMethod(host.context, "stencil_volume") == GN_ERROR_FEATURE_MISSING);
        host.draw(2, {});
        CHECK(host.takeMessages().size() == 1); // the refusal
        noCompute = false;
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that finds no memory for a larger view finds it when it is tried again")
{
    Scene scene = smallScene();
    for (int i = 0; i < 5; ++i)
        scene.lights.push_back(spotLight("more", {-4.0 + i, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
    // Six maps of 4 MiB, and 16 layers of visibility, 28 MiB once it is large.
    constexpr VkExtent2D large{1600, 1100};
    const VkDeviceSize limit = leastLimit(large);
    REQUIRE(limit > 0);
    CAPTURE(limit);
    Host host(scene, limited(limit));
    host.pinAll("shadow_map");
    host.draw(3, {});
    const std::vector<GnLight> one = {host.lights[0]};
    host.resize(large);
    GnResult result = GN_ERROR_OUT_OF_DEVICE_MEMORY;
    int failures = -1;
    for (; result == GN_ERROR_OUT_OF_DEVICE_MEMORY && failures < 8; ++failures)
        result = host.draw({.lights = &one, .adjust = [&](GnFrameInfo& frame, std::vector<GnViewFrame>&) {
                                // At first the maps' frame is in flight, however fast the device was.
                                if (failures < 0) frame.completedFrame = frame.frame - 2;
                            }});
    CHECK(result == GN_SUCCESS);
    CHECK(failures > 0); // else the limit is too high to show anything
    Host roomy(smallScene(), {.extent = large, .mapSide = 1024.0});
    roomy.pinAll("shadow_map");
    roomy.require(roomy.draw());
    CHECK(differences(host.pictures()[0], roomy.pictures()[0]) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a view that two sizes of visibility do not fit beside gets its new size all the same")
{
    Host host(smallScene(), limited(40 * kMiB));
    const std::vector<GnLight> none;
    host.resize({1280, 1024}); // 20 MiB
    host.require(host.draw({.lights = &none}));
    host.resize({1408, 1024}); // 22 MiB
    GnResult result = GN_ERROR_OUT_OF_DEVICE_MEMORY;
    for (int i = 0; result == GN_ERROR_OUT_OF_DEVICE_MEMORY && i < 8; ++i)
        result = host.draw({.lights = &none});
    CHECK(result == GN_SUCCESS);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that fails before it has a place in flight leaves the one before it in its own")
{
    Host host(smallScene(), limited(256 * kMiB, 1));
    host.pinAll("shadow_map");
    host.draw(2, {});
    const std::vector<Image8> good = host.pictures();
    CHECK(host.draw({.adjust = huge}) == GN_ERROR_OUT_OF_DEVICE_MEMORY);
    const auto early = [](GnFrameInfo& frame, std::vector<GnViewFrame>&) { frame.completedFrame = frame.frame - 2; };
    CHECK(host.draw({.adjust = early}) == GN_ERROR_FRAME_ORDER);
    CHECK(host.lastError().find("completedFrame") != std::string::npos);
    host.require(host.draw());
    CHECK(differences(host.pictures(), good) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "frames go without a depth grid that finds no memory, and measure once it does")
{
    Host host(smallScene(), watched());
    const std::string rules = shippedRules("default");
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "default"));
    failing.grids = true;
    host.draw(4, {});
    CHECK(host.passCount("view.depth_grid") == 0);
    CHECK_FALSE(host.decision(0).viewerDistanceMeasured);
    CHECK(dark(host.pictures()[0]) > 100);
    failing.grids = false;
    host.draw(4, {});
    CHECK(host.decision(0).viewerDistanceMeasured);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that finds no memory for constants or descriptors fails, and the next is whole")
{
    for (bool* const refused : {&failing.constants, &failing.pools})
        for (const char* method : {"shadow_map", "pcf_hybrid"}) {
            CAPTURE(refused == &failing.pools);
            CAPTURE(std::string(method));
            Host host(smallScene(), watched()), whole(smallScene(), {.extent = {320, 180}});
            for (Host* one : {&host, &whole}) {
                one->pinAll(method);
                // By the CPU, nothing of pcf_hybrid but its maps needs either.
                one->require(gnSetMethodSetting(one->context, "pcf_hybrid", "classify", 0.0));
            }
            *refused = true;
            CHECK(host.draw() == GN_ERROR_OUT_OF_DEVICE_MEMORY);
            *refused = false;
            host.require(host.draw());
            whole.require(whole.draw());
            CHECK(differences(host.pictures(), whole.pictures()) == 0);
        }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame whose casters the ray tracer has no memory for fails, and the next is whole")
{
    Host host(smallScene());
    host.pinAll("ray_traced");
    failing.rays = true;
    CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
    CHECK(host.lastError().find("ray tracer") != std::string::npos);
    failing.rays = false;
    host.require(host.draw());
    CHECK(differences(host.pictures(), fresh(smallScene(), "ray_traced", {320, 180})) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a context whose last submit was refused is destroyed all the same")
{
    {
        Host host(smallScene(), watched());
        host.pinAll("shadow_map");
        host.draw(2, {});
        queue.failAt = 0;
        CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
    }
    CHECK(queue.unlocked == 0);
    { // the very last one as well, which is destruction's own
        Host host(smallScene(), watched());
        host.pinAll("shadow_map");
        host.draw(2, {.call = Call::record});
        queue.failAt = 0;
    }
    CHECK(queue.unlocked == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame whose submits are refused, whichever, is drawn by the next attempt")
{
    for (const char* method : {"shadow_map", "ray_traced", "pcf_hybrid"}) {
        CAPTURE(std::string(method));
        const std::vector<Image8> good = fresh(smallScene(), method, {320, 180});
        for (uint32_t refused = 0; refused < 3; ++refused) {
            CAPTURE(refused);
            Host host(smallScene(), watched());
            host.pinAll(method);
            queue.submits = 0;
            queue.failAt = refused;
            const GnResult result = host.draw();
            if (result == GN_SUCCESS) {
                CHECK(refused == queue.submits); // the frame has no more
                queue.failAt = UINT32_MAX;
                break;
            }
            CHECK(result == GN_ERROR_OUT_OF_HOST_MEMORY);
            host.require(host.draw());
            CHECK(differences(host.pictures(), good) == 0);
            host.draw(2, {});
            CHECK(differences(host.pictures(), good) == 0);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "what a pass on a worker throws is the frame's failure and nobody's end")
{
    for (const GnPassKind kind : {GN_PASS_PREPARE, GN_PASS_HOST})
        for (const Call call : {Call::begin, Call::submit}) {
            CAPTURE(kind);
            CAPTURE(int(call));
            Thrower thrower;
            thrower.kind = kind;
            Host host(smallScene(), {.context = [](GnContextCreateInfo& info) { info.jobThreadCount = 3; }});
            thrower.join(host);
            const auto draw = [&] {
                const GnResult begun = host.draw({.call = call});
                return call == Call::begin && begun >= 0 ? host.finish(UINT64_MAX) : begun;
            };
            host.require(draw());
            thrower.throws = true;
            CHECK(draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
            thrower.throws = false;
            host.require(draw());
            host.pinAll("shadow_map");
            host.require(draw());
            CHECK(differences(host.pictures(), fresh(smallScene(), "shadow_map", {320, 180})) == 0);
        }
}

TEST_CASE_FIXTURE(DeviceTest, "a context is destroyed while a host pass of its throws")
{
    Thrower thrower;
    Host host(smallScene(), {.context = [](GnContextCreateInfo& info) { info.jobThreadCount = 3; }});
    thrower.join(host);
    thrower.throws = true;
    host.require(host.draw({.call = Call::begin}));
    gnDestroyContext(std::exchange(host.context, nullptr));
    CHECK(host.finish(0) == GN_ERROR_NULL_ARGUMENT); // only so that the test's host submits what it waits for
}
