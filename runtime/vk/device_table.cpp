#include "runtime/vk/device_table.hpp"

#include <algorithm>

namespace gnomon {
namespace {

Error nullArgument(const char* member)
{
    return {GN_ERROR_NULL_ARGUMENT, "NullArgument", std::string("GnContextCreateInfo::") + member + " is required"};
}

Result<void> checkGiven(const GnContextCreateInfo& info)
{
    if (!info.instance) return nullArgument("instance");
    if (!info.physicalDevice) return nullArgument("physicalDevice");
    if (!info.device) return nullArgument("device");
    if (!info.queue) return nullArgument("queue");
    if (!info.pEnabledFeatures) return nullArgument("pEnabledFeatures");
    if (!info.pfnGetInstanceProcAddr) return nullArgument("pfnGetInstanceProcAddr");
    if (info.enabledExtensionCount && !info.ppEnabledExtensionNames) return nullArgument("ppEnabledExtensionNames");
    for (std::uint32_t i = 0; i < info.enabledExtensionCount; ++i)
        if (!info.ppEnabledExtensionNames[i]) return nullArgument("ppEnabledExtensionNames[]");
    if (info.visibilityQueueFamilyCount && !info.pVisibilityQueueFamilies)
        return nullArgument("pVisibilityQueueFamilies");
    if ((info.pfnAllocateMemory == nullptr) != (info.pfnFreeMemory == nullptr))
        return Error{GN_ERROR_NULL_ARGUMENT, "MemoryHookHalf", "pfnAllocateMemory and pfnFreeMemory go together"};
    if (info.pipelineCacheDataSize && !info.pPipelineCacheData) return nullArgument("pPipelineCacheData");
    if (info.pipelineCacheDataSize && info.pipelineCache)
        return Error{GN_ERROR_OUT_OF_RANGE, "PipelineCacheTwice",
                     "pipelineCacheDataSize is " + std::to_string(info.pipelineCacheDataSize) +
                         ", but pipelineCache is given: its data are the host's to load"};
    if (info.apiVersion < VK_API_VERSION_1_3 || VK_API_VERSION_VARIANT(info.apiVersion) != 0)
        return Error{GN_ERROR_OUT_OF_RANGE, "ApiVersion",
                     "apiVersion is " + std::to_string(VK_API_VERSION_MAJOR(info.apiVersion)) + "." +
                         std::to_string(VK_API_VERSION_MINOR(info.apiVersion)) + "; gnomon needs Vulkan 1.3"};
    if (const char* feature = missingFeature(*info.pEnabledFeatures))
        return Error{GN_ERROR_FEATURE_MISSING, "FeatureMissing",
                     std::string(feature) + " is not enabled in pEnabledFeatures"};
    return {};
}

Error functionMissing(const char* name)
{
    return {GN_ERROR_FEATURE_MISSING, "FunctionMissing", std::string("the driver has no ") + name};
}

Result<void> loadFunctions(DeviceTable& table, PFN_vkGetInstanceProcAddr getInstanceProc)
{
#define GN_LOAD(name)                                                                                                  \
    table.name = reinterpret_cast<PFN_##name>(getInstanceProc(table.instance, #name));                                 \
    if (!table.name) return functionMissing(#name);
    GN_INSTANCE_FUNCTIONS(GN_LOAD)
#undef GN_LOAD
#define GN_LOAD(name)                                                                                                  \
    table.name = reinterpret_cast<PFN_##name>(table.vkGetDeviceProcAddr(table.device, #name));                         \
    if (!table.name) return functionMissing(#name);
    GN_DEVICE_FUNCTIONS(GN_LOAD)
    if (table.rayQuery()) {
        GN_RAY_FUNCTIONS(GN_LOAD)
    }
#undef GN_LOAD
    // An instance extension: its functions come from the instance. They may be absent although the extension was named.
    if (!table.hasExtension(VK_EXT_DEBUG_UTILS_EXTENSION_NAME)) return {};
#define GN_LOAD(name) table.name = reinterpret_cast<PFN_##name>(getInstanceProc(table.instance, #name));
    GN_OPTIONAL_DEVICE_FUNCTIONS(GN_LOAD)
#undef GN_LOAD
    return {};
}

Result<void> readQueueFamily(DeviceTable& table)
{
    std::uint32_t count = 0;
    table.vkGetPhysicalDeviceQueueFamilyProperties2(table.physicalDevice, &count, nullptr);
    table.queueFamilyCount = count;
    if (table.queueFamily >= count)
        return Error{GN_ERROR_OUT_OF_RANGE, "QueueFamily",
                     "queueFamilyIndex is " + std::to_string(table.queueFamily) + "; the device has " +
                         std::to_string(count) + " families"};
    std::vector<VkQueueFamilyProperties2> families(
        count, {.sType = VK_STRUCTURE_TYPE_QUEUE_FAMILY_PROPERTIES_2, .pNext = nullptr, .queueFamilyProperties = {}});
    table.vkGetPhysicalDeviceQueueFamilyProperties2(table.physicalDevice, &count, families.data());
    const VkQueueFamilyProperties& family = families[table.queueFamily].queueFamilyProperties;
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    if ((family.queueFlags & kNeeded) != kNeeded)
        return Error{GN_ERROR_FEATURE_MISSING, "QueueFamily",
                     "queue family " + std::to_string(table.queueFamily) + " does not do both graphics and compute"};
    table.timestampValidBits = family.timestampValidBits;
    return {};
}

Result<void> readDevice(DeviceTable& table, GnContextCreateFlags flags)
{
    VkPhysicalDeviceAccelerationStructurePropertiesKHR rays{};
    rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR;
    VkPhysicalDeviceProperties2 properties{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, table.rayQuery() ? &rays : nullptr, {}};
    table.vkGetPhysicalDeviceProperties2(table.physicalDevice, &properties);
    table.properties = properties.properties;
    table.scratchAlignment = std::max(rays.minAccelerationStructureScratchOffsetAlignment, 1u);
    if (table.properties.apiVersion < VK_API_VERSION_1_3)
        return Error{GN_ERROR_FEATURE_MISSING, "ApiVersion",
                     std::string("device ") + table.properties.deviceName + " is older than Vulkan 1.3"};
    table.software = table.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    table.prefersRays = table.rayQuery() && (!table.software || (flags & GN_CONTEXT_DEVICE_RAYS_BIT) != 0);
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{};
    budget.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT;
    const bool budgeted = table.hasExtension(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    VkPhysicalDeviceMemoryProperties2 memory{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2, budgeted ? &budget : nullptr, {}};
    table.vkGetPhysicalDeviceMemoryProperties2(table.physicalDevice, &memory);
    table.memory = memory.memoryProperties;
    for (std::uint32_t i = 0; i < table.memory.memoryHeapCount; ++i) {
        const VkDeviceSize size = table.memory.memoryHeaps[i].size;
        table.heapBudget[i] = budgeted ? std::min(budget.heapBudget[i], size) : size;
    }
    return readQueueFamily(table);
}

} // namespace

bool DeviceTable::hasExtension(const char* name) const noexcept
{
    return std::any_of(extensions.begin(), extensions.end(),
                       [name](const std::string& extension) { return extension == name; });
}

namespace {

/// Whether a structure of that type in the chain switches the feature on.
template <typename Features>
bool isOn(const VkPhysicalDeviceFeatures2& chain, VkStructureType type, VkBool32 Features::*feature) noexcept
{
    for (auto* at = static_cast<const VkBaseInStructure*>(chain.pNext); at; at = at->pNext)
        if (at->sType == type && reinterpret_cast<const Features*>(at)->*feature) return true;
    return false;
}

} // namespace

const char* missingFeature(const VkPhysicalDeviceFeatures2& chain) noexcept
{
    constexpr VkStructureType core12 = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                              core13 = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    if (!isOn(chain, core13, &VkPhysicalDeviceVulkan13Features::dynamicRendering) &&
        !isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES,
              &VkPhysicalDeviceDynamicRenderingFeatures::dynamicRendering))
        return "dynamicRendering";
    if (!isOn(chain, core13, &VkPhysicalDeviceVulkan13Features::synchronization2) &&
        !isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES,
              &VkPhysicalDeviceSynchronization2Features::synchronization2))
        return "synchronization2";
    if (!isOn(chain, core12, &VkPhysicalDeviceVulkan12Features::timelineSemaphore) &&
        !isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES,
              &VkPhysicalDeviceTimelineSemaphoreFeatures::timelineSemaphore))
        return "timelineSemaphore";
    return nullptr;
}

const char* missingForRayQuery(const VkPhysicalDeviceFeatures2& chain, std::span<const std::string> extensions) noexcept
{
    const auto names = [extensions](const char* name) {
        return std::ranges::find(extensions, name) != extensions.end();
    };
    if (!names(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME)) return "needs VK_KHR_acceleration_structure";
    if (!names(VK_KHR_RAY_QUERY_EXTENSION_NAME)) return "needs VK_KHR_ray_query";
    if (!isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
              &VkPhysicalDeviceAccelerationStructureFeaturesKHR::accelerationStructure))
        return "needs the feature accelerationStructure of VK_KHR_acceleration_structure";
    if (!isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR,
              &VkPhysicalDeviceRayQueryFeaturesKHR::rayQuery))
        return "needs the feature rayQuery of VK_KHR_ray_query";
    if (!isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
              &VkPhysicalDeviceVulkan12Features::bufferDeviceAddress) &&
        !isOn(chain, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
              &VkPhysicalDeviceBufferDeviceAddressFeatures::bufferDeviceAddress))
        return "needs bufferDeviceAddress";
    if (!chain.features.shaderFloat64) return "needs shaderFloat64"; // startsOn(), runtime/scene/long_edges.hpp
    return nullptr;
}

Result<std::unique_ptr<DeviceTable>> loadDeviceTable(const GnContextCreateInfo& info)
{
    if (Result<void> given = checkGiven(info); !given) return given.error();
    auto table = std::make_unique<DeviceTable>();
    table->instance = info.instance;
    table->physicalDevice = info.physicalDevice;
    table->device = info.device;
    table->queue = info.queue;
    table->queueFamily = info.queueFamilyIndex;
    if (info.pAllocationCallbacks) {
        table->hostCallbacks = *info.pAllocationCallbacks;
        table->hostAllocator = &table->hostCallbacks;
    }
    table->pipelineCache = info.pipelineCache;
    table->hostAllocateMemory = info.pfnAllocateMemory;
    table->hostFreeMemory = info.pfnFreeMemory;
    table->hostUserData = info.pUserData;
    table->enabled = info.pEnabledFeatures->features;
    table->extensions.assign(info.ppEnabledExtensionNames, info.ppEnabledExtensionNames + info.enabledExtensionCount);
    table->rayQueryMissing = missingForRayQuery(*info.pEnabledFeatures, table->extensions);
    if (Result<void> loaded = loadFunctions(*table, info.pfnGetInstanceProcAddr); !loaded) return loaded.error();
    if (Result<void> read = readDevice(*table, info.flags); !read) return read.error();
    return table;
}

bool supports(const DeviceTable& vk, VkFormat format, VkFormatFeatureFlags features)
{
    VkFormatProperties2 properties{VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2, nullptr, {}};
    vk.vkGetPhysicalDeviceFormatProperties2(vk.physicalDevice, format, &properties);
    return (properties.formatProperties.optimalTilingFeatures & features) == features;
}

Error vulkanError(VkResult result, const char* call)
{
    const auto failed = [call](const char* what) { return std::string(call) + " failed: " + what; };
    switch (result) {
    case VK_ERROR_DEVICE_LOST:
        return {GN_ERROR_DEVICE_LOST, "DeviceLost", failed("the device is lost")};
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return {GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory", failed("out of host memory")};
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_TOO_MANY_OBJECTS:
    case VK_ERROR_MEMORY_MAP_FAILED:
        return {GN_ERROR_OUT_OF_DEVICE_MEMORY, "OutOfDeviceMemory",
                failed("out of device memory") + " (VkResult " + std::to_string(result) + ")"};
    default:
        return {GN_ERROR_UNKNOWN, "VulkanFailed", failed("VkResult ") + std::to_string(result)};
    }
}

} // namespace gnomon
