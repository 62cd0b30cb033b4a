#include "device/failing.hpp"

#include <dlfcn.h>

#include <cstring>
#include <new>

#include "runtime/rays/embree.hpp"

namespace gnomon::test {

WatchedQueue queue;
Failing failing;

namespace {

VKAPI_ATTR VkResult VKAPI_CALL watchedSubmit(VkQueue handle, uint32_t count, const VkSubmitInfo2* submits,
                                             VkFence fence)
{
    ++queue.submits;
    queue.unlocked += !queue.locked;
    if (queue.failAt != UINT32_MAX && queue.failAt-- == 0) return queue.failure;
    return vkQueueSubmit2(handle, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL watchedCreateBuffer(VkDevice handle, const VkBufferCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkBuffer* buffer)
{
    if (failing.grids && info->usage == VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (failing.constants && (info->usage & VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT)) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return vkCreateBuffer(handle, info, allocator, buffer);
}

VKAPI_ATTR VkResult VKAPI_CALL watchedCreatePool(VkDevice handle, const VkDescriptorPoolCreateInfo* info,
                                                 const VkAllocationCallbacks* allocator, VkDescriptorPool* pool)
{
    return failing.pools ? VK_ERROR_OUT_OF_DEVICE_MEMORY : vkCreateDescriptorPool(handle, info, allocator, pool);
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

void GN_CALL throwIfTold(GnPassContext, void* user)
{
    if ((*static_cast<Thrower* const*>(user))->throws) throw std::bad_alloc();
}

void GN_CALL declareThrower(void* self, GnPassBuilder builder, const GnShadowTask* task)
{
    auto* const thrower = static_cast<Thrower*>(self);
    const GnPluginInterface& gn = *thrower->abi;
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
    pass.pfnRun = &throwIfTold;
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

} // namespace

HostOptions watched()
{
    queue = {};
    failing = {};
    return {.context = [](GnContextCreateInfo& info) {
        info.pfnGetInstanceProcAddr = &hookedGetInstanceProcAddr;
        info.pfnLockQueue = [](VkQueue, void*) { queue.locked = true; };
        info.pfnUnlockQueue = [](VkQueue, void*) { queue.locked = false; };
    }};
}

std::vector<Image8> fresh(const Scene& scene, const char* method, VkExtent2D extent)
{
    Host host(scene, {.extent = extent});
    host.pinAll(method);
    host.require(host.draw());
    return host.pictures();
}

void Thrower::join(Host& host)
{
    host.require(gnGetPluginInterface(host.context, &abi));
    GnAlgorithmInfo info{};
    info.pName = "thrower";
    info.traits = GN_TRAIT_SPOT_BIT;
    info.roundTrips = kind == GN_PASS_HOST;
    info.pfnDeclare = &declareThrower;
    info.pAlgorithm = this;
    host.require(gnRegisterAlgorithm(host.context, &info));
    host.pinAll("thrower");
}

} // namespace gnomon::test

// In place of Embree's own: the linker takes the program's.

namespace {

template <typename Function>
Function* embrees(const char* name)
{
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name)); // NOLINT: POSIX's own way
}

} // namespace

RTC_API RTCError rtcGetDeviceError(RTCDevice device)
{
    static const auto real = embrees<RTCError(RTCDevice)>("rtcGetDeviceError");
    return gnomon::test::failing.rays ? RTC_ERROR_OUT_OF_MEMORY : real(device);
}

/// Instances alone have one.
RTC_API void rtcSetGeometryTransform(RTCGeometry geometry, unsigned timeStep, RTCFormat format, const void* transform)
{
    static const auto real = embrees<void(RTCGeometry, unsigned, RTCFormat, const void*)>("rtcSetGeometryTransform");
    if (!gnomon::test::failing.rays) real(geometry, timeStep, format, transform);
}
