#pragma once
// Every Vulkan function gnomon calls, loaded through the host's vkGetInstanceProcAddr, and what is known of the device.
#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

#include "runtime/base/result.hpp"

namespace gnomon {

// clang-format off
#define GN_INSTANCE_FUNCTIONS(X) \
    X(vkGetPhysicalDeviceProperties2) X(vkGetPhysicalDeviceMemoryProperties2) X(vkGetPhysicalDeviceFeatures2) \
    X(vkGetPhysicalDeviceQueueFamilyProperties2) X(vkGetPhysicalDeviceFormatProperties2) \
    X(vkGetDeviceProcAddr)

#define GN_DEVICE_FUNCTIONS(X) \
    X(vkAllocateMemory) X(vkFreeMemory) X(vkMapMemory) \
    \
    X(vkCreateBuffer) X(vkDestroyBuffer) X(vkBindBufferMemory2) X(vkGetBufferMemoryRequirements2) \
    X(vkCreateImage) X(vkDestroyImage) X(vkBindImageMemory2) X(vkGetImageMemoryRequirements2) \
    X(vkCreateImageView) X(vkDestroyImageView) X(vkCreateSampler) X(vkDestroySampler) \
    X(vkCreateShaderModule) X(vkDestroyShaderModule) X(vkCreatePipelineLayout) X(vkDestroyPipelineLayout) \
    X(vkCreatePipelineCache) X(vkDestroyPipelineCache) X(vkGetPipelineCacheData) \
    X(vkCreateGraphicsPipelines) X(vkCreateComputePipelines) X(vkDestroyPipeline) X(vkCreateDescriptorSetLayout) X(vkDestroyDescriptorSetLayout) X(vkCreateDescriptorPool) \
    X(vkDestroyDescriptorPool) X(vkAllocateDescriptorSets) X(vkUpdateDescriptorSets) \
    X(vkCreateCommandPool) X(vkDestroyCommandPool) X(vkResetCommandPool) X(vkAllocateCommandBuffers) \
    X(vkBeginCommandBuffer) X(vkEndCommandBuffer) X(vkQueueSubmit2) \
    X(vkCreateSemaphore) X(vkDestroySemaphore) X(vkWaitSemaphores) \
    X(vkCreateQueryPool) X(vkDestroyQueryPool) X(vkGetQueryPoolResults) X(vkCmdResetQueryPool) X(vkCmdWriteTimestamp2) \
    X(vkCmdPipelineBarrier2) X(vkCmdBeginRendering) X(vkCmdEndRendering) X(vkCmdBindPipeline) \
    X(vkCmdBindDescriptorSets) X(vkCmdBindVertexBuffers) X(vkCmdBindIndexBuffer) X(vkCmdPushConstants) \
    X(vkCmdSetViewport) X(vkCmdSetScissor) X(vkCmdSetCullMode) X(vkCmdSetFrontFace) X(vkCmdSetDepthBias) \
    X(vkCmdDraw) X(vkCmdDrawIndexed) X(vkCmdDrawIndirect) X(vkCmdDrawIndexedIndirect) \
    X(vkCmdDispatch) X(vkCmdClearColorImage) X(vkCmdClearDepthStencilImage) \
    X(vkCmdCopyImage2) X(vkCmdCopyBuffer2) X(vkCmdCopyBufferToImage2) \
    X(vkCmdCopyImageToBuffer2) X(vkCmdFillBuffer) X(vkCmdUpdateBuffer)

/// Null where the extension is not enabled.
#define GN_OPTIONAL_DEVICE_FUNCTIONS(X) \
    X(vkCmdBeginDebugUtilsLabelEXT) X(vkCmdEndDebugUtilsLabelEXT) X(vkSetDebugUtilsObjectNameEXT)
/// Loaded where DeviceTable::rayQuery() holds.
#define GN_RAY_FUNCTIONS(X) \
    X(vkGetBufferDeviceAddress) X(vkCreateAccelerationStructureKHR) X(vkDestroyAccelerationStructureKHR) \
    X(vkGetAccelerationStructureBuildSizesKHR) X(vkGetAccelerationStructureDeviceAddressKHR) \
    X(vkCmdBuildAccelerationStructuresKHR) X(vkCmdCopyAccelerationStructureKHR) \
    X(vkCmdWriteAccelerationStructuresPropertiesKHR)
// clang-format on

struct DeviceTable {
    DeviceTable() = default;
    DeviceTable(const DeviceTable&) = delete; // hostAllocator points into it
    DeviceTable& operator=(const DeviceTable&) = delete;

#define GN_DECLARE(name) PFN_##name name = nullptr;
    GN_INSTANCE_FUNCTIONS(GN_DECLARE)
    GN_DEVICE_FUNCTIONS(GN_DECLARE)
    GN_OPTIONAL_DEVICE_FUNCTIONS(GN_DECLARE)
    GN_RAY_FUNCTIONS(GN_DECLARE)
#undef GN_DECLARE

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    std::uint32_t queueFamily = 0, queueFamilyCount = 0;
    const VkAllocationCallbacks* hostAllocator = nullptr; ///< hostCallbacks, or null.
    VkAllocationCallbacks hostCallbacks{};
    VkPipelineCache pipelineCache = VK_NULL_HANDLE; ///< The host's, or null.
    /// The host's source of device memory, or null; both or neither.
    PFN_gnAllocateMemory hostAllocateMemory = nullptr;
    PFN_gnFreeMemory hostFreeMemory = nullptr;
    void* hostUserData = nullptr;

    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory{};
    /// Bytes of each heap that the process may take, as the table was loaded: by VK_EXT_memory_budget, or all of it.
    std::array<VkDeviceSize, VK_MAX_MEMORY_HEAPS> heapBudget{};
    VkPhysicalDeviceFeatures enabled{}; ///< What the host enabled, not what the device could.
    std::uint32_t timestampValidBits = 0;
    /// Null where the host enabled all that ray queries need; else what is missing first, as methods say it.
    const char* rayQueryMissing = "needs VK_KHR_ray_query";
    std::uint32_t scratchAlignment = 1; ///< Of builds of acceleration structures, bytes.
    bool software = false;              ///< VK_PHYSICAL_DEVICE_TYPE_CPU: the device shares the CPU's cores.
    bool prefersRays = false;           ///< rayQuery(), and what either may trace is traced on the device: a software
                                        ///< one takes twice as long as Embree does on the same cores.

    /// Vulkan objects and memory blocks made so far; GnFrameStats::deviceAllocations is the difference over a frame.
    mutable std::atomic<std::uint64_t> objectsMade{0};
    mutable std::atomic<std::uint64_t> pipelinesMade{0};

    bool hasExtension(const char* name) const noexcept;
    bool rayQuery() const noexcept
    {
        return rayQueryMissing == nullptr;
    }
    std::vector<std::string> extensions; ///< Enabled by the host.
};

/// Checks the create-info's device part and loads the functions.
/// Errors: GN_ERROR_NULL_ARGUMENT, GN_ERROR_OUT_OF_RANGE (apiVersion), GN_ERROR_FEATURE_MISSING naming the feature.
Result<std::unique_ptr<DeviceTable>> loadDeviceTable(const GnContextCreateInfo& info);

/// Name of the first feature gnomon cannot do without that the chain does not switch on, or null. Understands the
/// structures of Vulkan 1.2 and 1.3 and those of the single features.
const char* missingFeature(const VkPhysicalDeviceFeatures2& chain) noexcept;

/// What of ray queries the chain and the extensions leave out, as methods say it, or null.
const char* missingForRayQuery(const VkPhysicalDeviceFeatures2& chain,
                               std::span<const std::string> extensions) noexcept;

/// Whether images of the format can be all of that.
bool supports(const DeviceTable& vk, VkFormat format, VkFormatFeatureFlags features);

/// Names the object for captures and validation messages, where VK_EXT_debug_utils is enabled.
template <typename Handle>
void nameObject(const DeviceTable& vk, VkObjectType type, Handle handle, const char* name) noexcept
{
    if (!vk.vkSetDebugUtilsObjectNameEXT) return;
    std::uint64_t bits = 0; // handles are pointers or 64-bit integers, by platform
    std::memcpy(&bits, &handle, sizeof(handle));
    const VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, type, bits,
                                             name};
    static_cast<void>(vk.vkSetDebugUtilsObjectNameEXT(vk.device, &info)); // a lost name harms nothing
}

/// GN_ERROR_DEVICE_LOST, out of memory, or unknown, with the call's name.
Error vulkanError(VkResult result, const char* call);

} // namespace gnomon
