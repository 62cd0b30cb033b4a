#include "device/draw_counter.hpp"

#include <cstring>
#include <vector>

namespace gnomon::test {
namespace {

constexpr uint32_t kMostDraws = 16384; ///< In one frame.

struct Pools {
    VkQueryPool samples = VK_NULL_HANDLE, triangles = VK_NULL_HANDLE;
    bool open = false;
    uint32_t used = 0;
};
Pools pools;
PFN_vkCmdDrawIndexedIndirect drawIndexedIndirect = nullptr;

VKAPI_ATTR void VKAPI_CALL countedDrawIndexedIndirect(VkCommandBuffer cmd, VkBuffer buffer, VkDeviceSize offset,
                                                      uint32_t count, uint32_t stride)
{
    const bool counted = pools.open && pools.used < kMostDraws;
    const uint32_t query = pools.used;
    if (counted) {
        ++pools.used;
        vkCmdBeginQuery(cmd, pools.samples, query, VK_QUERY_CONTROL_PRECISE_BIT);
        vkCmdBeginQuery(cmd, pools.triangles, query, 0);
    }
    drawIndexedIndirect(cmd, buffer, offset, count, stride);
    if (counted) {
        vkCmdEndQuery(cmd, pools.triangles, query);
        vkCmdEndQuery(cmd, pools.samples, query);
    }
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    const PFN_vkVoidFunction real = vkGetDeviceProcAddr(handle, name);
    if (std::strcmp(name, "vkCmdDrawIndexedIndirect") != 0) return real;
    drawIndexedIndirect = reinterpret_cast<PFN_vkCmdDrawIndexedIndirect>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&countedDrawIndexedIndirect);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&hookedGetDeviceProcAddr);
    return vkGetInstanceProcAddr(instance, name);
}

VkQueryPool makePool(VkQueryType type, VkQueryPipelineStatisticFlags statistics)
{
    const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                     .queryType = type,
                                     .queryCount = kMostDraws,
                                     .pipelineStatistics = statistics};
    VkQueryPool pool = VK_NULL_HANDLE;
    demo::vkCheck(vkCreateQueryPool(device().handle, &info, nullptr, &pool), "vkCreateQueryPool");
    return pool;
}

uint64_t sum(VkQueryPool pool, uint32_t count)
{
    std::vector<uint64_t> values(count);
    if (count == 0) return 0;
    demo::vkCheck(vkGetQueryPoolResults(device().handle, pool, 0, count, count * sizeof(uint64_t), values.data(),
                                        sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                  "vkGetQueryPoolResults");
    uint64_t total = 0;
    for (const uint64_t value : values)
        total += value;
    return total;
}

} // namespace

DrawCounter::DrawCounter()
{
    pools.samples = makePool(VK_QUERY_TYPE_OCCLUSION, 0);
    pools.triangles =
        makePool(VK_QUERY_TYPE_PIPELINE_STATISTICS, VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_PRIMITIVES_BIT);
}

DrawCounter::~DrawCounter()
{
    vkDestroyQueryPool(device().handle, pools.samples, nullptr);
    vkDestroyQueryPool(device().handle, pools.triangles, nullptr);
    pools = {};
}

bool DrawCounter::possible()
{
    VkPhysicalDeviceVulkan12Features present12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 present{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &present12};
    vkGetPhysicalDeviceFeatures2(device().physicalDevice, &present);
    return present12.hostQueryReset && present.features.occlusionQueryPrecise &&
           present.features.pipelineStatisticsQuery;
}

HostOptions DrawCounter::options(HostOptions base) const
{
    base.context = [](GnContextCreateInfo& info) { info.pfnGetInstanceProcAddr = &hookedGetInstanceProcAddr; };
    return base;
}

DrawCount DrawCounter::count(Host& host, const FrameOptions& frame)
{
    vkResetQueryPool(device().handle, pools.samples, 0, kMostDraws);
    vkResetQueryPool(device().handle, pools.triangles, 0, kMostDraws);
    pools.used = 0;
    pools.open = true;
    host.require(host.draw(frame));
    pools.open = false;
    host.pictures();
    REQUIRE(pools.used < kMostDraws);
    return {
        .draws = pools.used, .triangles = sum(pools.triangles, pools.used), .samples = sum(pools.samples, pools.used)};
}

} // namespace gnomon::test
