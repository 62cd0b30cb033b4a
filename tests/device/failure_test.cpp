// Frames that fail half-way: for memory, at a submit, in a host pass. The next attempt is as if nothing had been.
#include <dlfcn.h>
#include <embree3/rtcore.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "device/fixture.hpp"
#include "gnomon/algorithm.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkDeviceSize kMiB = 1u << 20;

// --- a queue that refuses work, and whose lock is watched ---

struct WatchedQueue {
    uint32_t failAt = UINT32_MAX; ///< Submits to go until one fails.
    bool locked = false;
    uint32_t submits = 0, unlocked = 0; ///< gnomon's; those without the lock.
};
WatchedQueue queue;

VKAPI_ATTR VkResult VKAPI_CALL watchedSubmit(VkQueue handle, uint32_t count, const VkSubmitInfo2* submits,
                                             VkFence fence)
{
    ++queue.submits;
    queue.unlocked += !queue.locked;
    if (queue.failAt != UINT32_MAX && queue.failAt-- == 0) return VK_ERROR_OUT_OF_HOST_MEMORY;
    return vkQueueSubmit2(handle, count, submits, fence);
}

// No buffer is made that is nothing but a storage buffer: depth grids alone are. None for constants; no descriptor
// pool.
bool noGrids = false, noConstants = false, noPools = false;
bool noRays = false; ///< Embree says that it ran out of memory.

VKAPI_ATTR VkResult VKAPI_CALL watchedCreateBuffer(VkDevice handle, const VkBufferCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkBuffer* buffer)
{
    if (noGrids && info->usage == VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (noConstants && (info->usage & VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT)) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return vkCreateBuffer(handle, info, allocator, buffer);
}

VKAPI_ATTR VkResult VKAPI_CALL watchedCreatePool(VkDevice handle, const VkDescriptorPoolCreateInfo* info,
                                                 const VkAllocationCallbacks* allocator, VkDescriptorPool* pool)
{
    return noPools ? VK_ERROR_OUT_OF_DEVICE_MEMORY : vkCreateDescriptorPool(handle, info, allocator, pool);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    if (std::strcmp(name, "vkCreateBuffer") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&watchedCreateBuffer);
    if (std::strcmp(name, "vkCreateDescriptorPool") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&watchedCreatePool);
    if (std::strcmp(name, "vkQueueSubmit2") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&watchedSubmit);
    return vkGetDeviceProcAddr(handle, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&hookedGetDeviceProcAddr);
    return vkGetInstanceProcAddr(instance, name);
}

HostOptions watched()
{
    queue = {};
    noGrids = noConstants = noPools = false;
    return {.context = [](GnContextCreateInfo& info) {
        info.pfnGetInstanceProcAddr = &hookedGetInstanceProcAddr;
        info.pfnLockQueue = [](VkQueue, void*) { queue.locked = true; };
        info.pfnUnlockQueue = [](VkQueue, void*) { queue.locked = false; };
    }};
}

HostOptions limited(VkDeviceSize limit, uint32_t framesInFlight = 2)
{
    return {.framesInFlight = framesInFlight,
            .context = [limit](GnContextCreateInfo& info) { info.memoryLimit = limit; }};
}

std::vector<Image8> fresh(const Scene& scene, const char* method, VkExtent2D extent)
{
    Host host(scene, {.extent = extent});
    host.pinAll(method);
    host.require(host.draw());
    return host.pictures();
}

/// Visibility of 1 GiB.
void huge(GnFrameInfo&, std::vector<GnViewFrame>& views)
{
    views[0].imageExtent = {8192, 8192};
}

// --- a method whose passes can be made to throw ---

struct Thrower {
    const GnPluginInterface* door = nullptr;
    GnPassKind kind = GN_PASS_HOST;
    bool throws = false;
    static void GN_CALL run(GnPassContext, void* user)
    {
        if ((*static_cast<Thrower* const*>(user))->throws) throw std::bad_alloc();
    }
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        auto* const thrower = static_cast<Thrower*>(self);
        const GnPluginInterface& gn = *thrower->door;
        GnBufferInfo buffer{};
        buffer.pName = "thrower.value";
        buffer.scope = GN_SCOPE_TASK;
        buffer.size = 4;
        buffer.place = GN_BUFFER_UPLOAD;
        GnAccess value{}, fill{};
        value.kind = GN_ACCESS_WRITE;
        value.buffer = gn.pfnBuffer(builder, &buffer);
        GnPassInfo pass{};
        pass.pName = "thrower.run";
        pass.kind = thrower->kind;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 1;
        pass.pAccesses = &value;
        pass.pfnRun = &run;
        pass.pUserData = &thrower;
        pass.userDataSize = sizeof thrower;
        gn.pfnPass(builder, &pass);
        value.kind = GN_ACCESS_READ;
        fill.kind = GN_ACCESS_WRITE;
        fill.image = task->visibility;
        fill.baseLayer = task->layer;
        fill.clear = VK_TRUE;
        const GnAccess accesses[] = {value, fill};
        pass = {};
        pass.pName = "thrower.fill";
        pass.kind = GN_PASS_RASTER;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 2;
        pass.pAccesses = accesses;
        pass.area = task->area;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        gn.pfnPass(builder, &pass);
    }
    void join(Host& host)
    {
        host.require(gnGetPluginInterface(host.context, &door));
        GnAlgorithmInfo info{};
        info.pName = "thrower";
        info.traits = GN_TRAIT_SPOT_BIT;
        info.roundTrips = kind == GN_PASS_HOST;
        info.pfnDeclare = &declare;
        info.pAlgorithm = this;
        host.require(gnRegisterAlgorithm(host.context, &info));
        host.pinAll("thrower");
    }
};

/// A method that writes its visibility from a pass that cannot.
struct Storer {
    const GnPluginInterface* door = nullptr;
    GnPassKind pass = GN_PASS_COMPUTE;
    GnAccessKind access = GN_ACCESS_WRITE;
    GnResult answer = GN_SUCCESS;
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        auto& storer = *static_cast<Storer*>(self);
        GnAccess store{};
        store.kind = storer.access;
        store.image = task->visibility;
        store.baseLayer = task->layer;
        GnPassInfo pass{};
        pass.pName = "storer.store";
        pass.kind = storer.pass;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 1;
        pass.pAccesses = &store;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        pass.pfnRun = [](GnPassContext, void*) {};
        storer.answer = storer.door->pfnPass(builder, &pass);
    }
};

} // namespace

/// In place of Embree's own: the linker takes the program's.
RTC_API RTCError rtcGetDeviceError(RTCDevice device)
{
    static const auto real =
        reinterpret_cast<RTCError (*)(RTCDevice)>(dlsym(RTLD_NEXT, "rtcGetDeviceError")); // NOLINT: POSIX's own way
    return noRays ? RTC_ERROR_OUT_OF_MEMORY : real(device);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that finds no memory for a larger view finds it when it is tried again")
{
    Scene scene = smallScene();
    for (int i = 0; i < 5; ++i)
        scene.lights.push_back(spotLight("more", {-4.0 + i, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
    Host host(scene, limited(48 * kMiB)); // six maps of 4 MiB, and 16 layers of visibility, 28 MiB once it is large
    host.pinAll("shadow_map");
    host.draw(3, {});
    const std::vector<GnLight> one = {host.lights[0]};
    constexpr VkExtent2D large{1600, 1100};
    host.resize(large);
    GnResult result = GN_ERROR_OUT_OF_DEVICE_MEMORY;
    int failures = -1;
    for (; result == GN_ERROR_OUT_OF_DEVICE_MEMORY && failures < 8; ++failures)
        result = host.draw({.lights = &one});
    CHECK(result == GN_SUCCESS);
    CHECK(failures > 0); // else the limit is too high to show anything
    CHECK(differences(host.pictures()[0], fresh(smallScene(), "shadow_map", large)[0]) == 0);
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
    noGrids = true;
    host.draw(4, {});
    CHECK(host.passCount("view.depth_grid") == 0);
    CHECK_FALSE(host.decision(0).viewerDistanceMeasured);
    CHECK(dark(host.pictures()[0]) > 100);
    noGrids = false;
    host.draw(4, {});
    CHECK(host.decision(0).viewerDistanceMeasured);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame that finds no memory for constants or descriptors fails, and the next is whole")
{
    for (bool* const refused : {&noConstants, &noPools})
        for (const char* method : {"shadow_map", "pcf_hybrid"}) {
            CAPTURE(refused == &noPools);
            CAPTURE(std::string(method));
            Host host(smallScene(), watched());
            host.pinAll(method);
            *refused = true;
            CHECK(host.draw() == GN_ERROR_OUT_OF_DEVICE_MEMORY);
            *refused = false;
            host.require(host.draw());
            CHECK(differences(host.pictures(), fresh(smallScene(), method, {320, 180})) == 0);
        }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame whose casters the ray tracer has no memory for fails, and the next is whole")
{
    Host host(smallScene());
    host.pinAll("ray_traced");
    noRays = true;
    CHECK(host.draw() == GN_ERROR_OUT_OF_HOST_MEMORY);
    CHECK(host.lastError().find("ray tracer") != std::string::npos);
    noRays = false;
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
            if (kind == GN_PASS_HOST && call == Call::begin) continue; // the test's host has counted the frame
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

TEST_CASE_FIXTURE(DeviceTest, "a foreign pass that would write a storage image is refused, and its light is lit")
{
    Host host(smallScene());
    Storer storer;
    host.require(gnGetPluginInterface(host.context, &storer.door));
    GnAlgorithmInfo info{};
    info.pName = "storer";
    info.traits = GN_TRAIT_SPOT_BIT;
    info.pfnDeclare = &Storer::declare;
    info.pAlgorithm = &storer;
    host.require(gnRegisterAlgorithm(host.context, &info));
    host.pinAll("storer");
    const std::pair<GnPassKind, GnAccessKind> refused[] = {{GN_PASS_COMPUTE, GN_ACCESS_WRITE},
                                                           {GN_PASS_COMPUTE, GN_ACCESS_UPDATE},
                                                           {GN_PASS_RASTER, GN_ACCESS_UPDATE},
                                                           {GN_PASS_PREPARE, GN_ACCESS_WRITE}};
    for (const auto& [pass, access] : refused) {
        storer.pass = pass;
        storer.access = access;
        storer.answer = GN_SUCCESS;
        host.takeMessages();
        host.require(host.draw());
        CHECK(storer.answer == GN_ERROR_UNSUPPORTED);
        const std::vector<std::string> messages = host.takeMessages();
        REQUIRE(messages.size() == 1);
        CHECK(messages[0].find("storer.store") != std::string::npos);
        const Image8 picture = host.pictures()[0];
        CHECK(lit(picture) == picture.texels.size());
    }
}
