// Loading the device's functions and refusing devices that cannot serve, against stub functions.
#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "runtime/vk/device_table.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

/// A complete create-info; tests take parts away. Handles are addresses of nothing in particular.
struct Given {
    int thing = 0;
    VkPhysicalDeviceVulkan13Features features13{};
    VkPhysicalDeviceVulkan12Features features12{};
    VkPhysicalDeviceFeatures2 features{};
    GnContextCreateInfo info{};

    Given()
    {
        features13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
        features13.dynamicRendering = features13.synchronization2 = VK_TRUE;
        features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
        features12.pNext = &features13;
        features12.timelineSemaphore = VK_TRUE;
        features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
        features.pNext = &features12;
        features.features.depthClamp = VK_TRUE;
        info.instance = reinterpret_cast<VkInstance>(&thing);
        info.physicalDevice = reinterpret_cast<VkPhysicalDevice>(&thing);
        info.device = reinterpret_cast<VkDevice>(&thing);
        info.queue = reinterpret_cast<VkQueue>(&thing);
        info.apiVersion = VK_API_VERSION_1_3;
        info.pEnabledFeatures = &features;
        info.pfnGetInstanceProcAddr = &StubVulkan::getInstanceProcAddr;
    }
    Given(const Given&) = delete;
};

void checkRefused(const GnContextCreateInfo& info, GnResult result, const std::string& word)
{
    Result<std::unique_ptr<DeviceTable>> table = loadDeviceTable(info);
    REQUIRE(!table);
    CHECK(table.error().result == result);
    CHECK_MESSAGE(table.error().text.find(word) != std::string::npos, table.error().text);
}

} // namespace

TEST_CASE("a complete description loads every function and reads the device")
{
    StubVulkan stub;
    stub.table.properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_CPU;
    Given given;
    const char* extensions[] = {"VK_EXT_one", "VK_EXT_two"};
    given.info.enabledExtensionCount = 2;
    given.info.ppEnabledExtensionNames = extensions;
    Result<std::unique_ptr<DeviceTable>> loaded = loadDeviceTable(given.info);
    REQUIRE(loaded);
    const DeviceTable& table = **loaded;
    CHECK(static_cast<bool>(table.vkCmdBeginRendering));
    CHECK(static_cast<bool>(table.vkCmdUpdateBuffer));
    CHECK(table.software);
    CHECK(table.timestampValidBits == 48);
    CHECK(table.memory.memoryTypeCount == 1);
    CHECK(table.enabled.depthClamp == VK_TRUE);
    CHECK(table.enabled.geometryShader == VK_FALSE);
    CHECK(table.hasExtension("VK_EXT_two"));
    CHECK_FALSE(table.hasExtension("VK_EXT_three"));
}

TEST_CASE("where the host enables VK_EXT_memory_budget a heap counts as what the process may take of it")
{
    StubVulkan stub;
    stub.table.memory.memoryHeapCount = 2;
    stub.table.memory.memoryHeaps[0].size = 1000; // the stub's budgets are a half, and twice its size
    stub.table.memory.memoryHeaps[1].size = 600;
    Given given;
    const Result<std::unique_ptr<DeviceTable>> plain = loadDeviceTable(given.info);
    REQUIRE(plain);
    CHECK((*plain)->heapBudget[0] == 1000);
    CHECK((*plain)->heapBudget[1] == 600);
    const char* extension = VK_EXT_MEMORY_BUDGET_EXTENSION_NAME;
    given.info.enabledExtensionCount = 1;
    given.info.ppEnabledExtensionNames = &extension;
    const Result<std::unique_ptr<DeviceTable>> budgeted = loadDeviceTable(given.info);
    REQUIRE(budgeted);
    CHECK((*budgeted)->heapBudget[0] == 500);
    CHECK((*budgeted)->heapBudget[1] == 600);
}

TEST_CASE("each required handle is missed by name")
{
    StubVulkan stub;
    const auto without = [](auto member, const char* name) {
        Given given;
        given.info.*member = {};
        checkRefused(given.info, GN_ERROR_NULL_ARGUMENT, name);
    };
    without(&GnContextCreateInfo::instance, "instance");
    without(&GnContextCreateInfo::physicalDevice, "physicalDevice");
    without(&GnContextCreateInfo::device, "::device");
    without(&GnContextCreateInfo::queue, "queue");
    without(&GnContextCreateInfo::pEnabledFeatures, "pEnabledFeatures");
    without(&GnContextCreateInfo::pfnGetInstanceProcAddr, "pfnGetInstanceProcAddr");
    Given given;
    given.info.enabledExtensionCount = 1;
    checkRefused(given.info, GN_ERROR_NULL_ARGUMENT, "ppEnabledExtensionNames");
}

TEST_CASE("each required feature is missed by name, wherever the host keeps it")
{
    StubVulkan stub;
    {
        Given given;
        given.features13.dynamicRendering = VK_FALSE;
        checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "dynamicRendering");
    }
    {
        Given given;
        given.features13.synchronization2 = VK_FALSE;
        checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "synchronization2");
    }
    Given given;
    given.features12.timelineSemaphore = VK_FALSE;
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "timelineSemaphore");

    VkPhysicalDeviceTimelineSemaphoreFeatures timeline{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES,
                                                       nullptr, VK_TRUE};
    VkPhysicalDeviceSynchronization2Features synchronization{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES, &timeline, VK_TRUE};
    VkPhysicalDeviceDynamicRenderingFeatures rendering{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES,
                                                       &synchronization, VK_TRUE};
    given.features.pNext = &rendering;
    CHECK(loadDeviceTable(given.info));
    given.features.pNext = nullptr;
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "dynamicRendering");
}

TEST_CASE("versions, queue families and drivers that will not do are refused with the reason")
{
    StubVulkan stub;
    Given given;
    given.info.apiVersion = VK_API_VERSION_1_2;
    checkRefused(given.info, GN_ERROR_OUT_OF_RANGE, "apiVersion is 1.2");
    given.info.apiVersion = VK_API_VERSION_1_3;
    given.info.queueFamilyIndex = 1;
    checkRefused(given.info, GN_ERROR_OUT_OF_RANGE, "queueFamilyIndex is 1");
    given.info.queueFamilyIndex = 0;
    stub.queueFlags = VK_QUEUE_GRAPHICS_BIT;
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "compute");
    stub.queueFlags |= VK_QUEUE_COMPUTE_BIT;
    stub.absentFunction = "vkCmdPipelineBarrier2";
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "vkCmdPipelineBarrier2");
    stub.absentFunction = "vkGetDeviceProcAddr";
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "vkGetDeviceProcAddr");
    stub.absentFunction.clear();
    stub.deviceVersion = VK_API_VERSION_1_2;
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "stub is older than Vulkan 1.3");
}

TEST_CASE("debug names are used only where the host enabled them")
{
    StubVulkan stub;
    Given given;
    Result<std::unique_ptr<DeviceTable>> plain = loadDeviceTable(given.info);
    REQUIRE(plain);
    CHECK_FALSE(static_cast<bool>((*plain)->vkSetDebugUtilsObjectNameEXT));
    CHECK(stub.loaded.count("vkSetDebugUtilsObjectNameEXT") == 0);
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    given.info.enabledExtensionCount = 1;
    given.info.ppEnabledExtensionNames = &extension;
    Result<std::unique_ptr<DeviceTable>> named = loadDeviceTable(given.info);
    REQUIRE(named);
    CHECK(static_cast<bool>((*named)->vkSetDebugUtilsObjectNameEXT));
}

TEST_CASE("device needs name what to enable, and why a device will not do")
{
    StubVulkan stub;
    stub.deviceFeatures.depthClamp = VK_TRUE;
    stub.deviceFeatures.wideLines = VK_TRUE;
    int thing = 0;
    const auto instance = reinterpret_cast<VkInstance>(&thing);
    const auto device = reinterpret_cast<VkPhysicalDevice>(&thing);
    GnDeviceNeeds needs{};
    CHECK(gnQueryDeviceNeeds(instance, device, &StubVulkan::getInstanceProcAddr, &needs) == GN_SUCCESS);
    CHECK(needs.supported == VK_TRUE);
    CHECK(needs.apiVersion == VK_API_VERSION_1_3);
    CHECK(needs.optional.depthClamp == VK_TRUE);
    CHECK(needs.optional.geometryShader == VK_FALSE); // the device has none
    CHECK(needs.optional.wideLines == VK_FALSE);      // of no use
    CHECK(std::string(needs.reason).empty());

    const auto refusal = [&]() -> std::string {
        CHECK(gnQueryDeviceNeeds(instance, device, &StubVulkan::getInstanceProcAddr, &needs) ==
              GN_ERROR_FEATURE_MISSING);
        CHECK(needs.supported == VK_FALSE);
        return needs.reason;
    };
    stub.hasDynamicRendering = false;
    CHECK(refusal() == "the device lacks dynamicRendering");
    stub.hasDynamicRendering = true;
    stub.queueFlags = VK_QUEUE_COMPUTE_BIT;
    CHECK(refusal() == "no queue family does both graphics and compute");
    stub.deviceVersion = VK_API_VERSION_1_1;
    CHECK(refusal() == "the device offers Vulkan 1.1; gnomon needs 1.3");
    stub.absentFunction = "vkGetPhysicalDeviceFeatures2";
    CHECK(refusal() == "the instance is older than Vulkan 1.1");
    CHECK(gnQueryDeviceNeeds(instance, device, nullptr, &needs) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnQueryDeviceNeeds(instance, device, &StubVulkan::getInstanceProcAddr, nullptr) == GN_ERROR_NULL_ARGUMENT);
    needs.structSize = 0;
    CHECK(gnQueryDeviceNeeds(instance, device, &StubVulkan::getInstanceProcAddr, &needs) == GN_ERROR_OUT_OF_RANGE);
    needs.structSize = offsetof(GnDeviceNeeds, supported) + sizeof needs.supported; // as an older host may have it
    needs.reason[0] = '?';
    CHECK(gnQueryDeviceNeeds(instance, device, &StubVulkan::getInstanceProcAddr, &needs) == GN_ERROR_FEATURE_MISSING);
    CHECK(needs.reason[0] == '?');
}

namespace {

constexpr const char* kRayExtensions[] = {"VK_KHR_deferred_host_operations", "VK_KHR_acceleration_structure",
                                          "VK_KHR_ray_query"};

GnDeviceNeeds needsOfStub()
{
    int thing = 0;
    GnDeviceNeeds needs{};
    CHECK(gnQueryDeviceNeeds(reinterpret_cast<VkInstance>(&thing), reinterpret_cast<VkPhysicalDevice>(&thing),
                             &StubVulkan::getInstanceProcAddr, &needs) == GN_SUCCESS);
    return needs;
}

} // namespace

TEST_CASE("what rays on the device need is listed where the device has all of it, and else nothing is")
{
    StubVulkan stub;
    stub.deviceFeatures.shaderFloat64 = VK_TRUE;
    stub.deviceExtensions.assign(std::begin(kRayExtensions), std::end(kRayExtensions));
    stub.deviceExtensions.insert(stub.deviceExtensions.begin(), "VK_KHR_swapchain");
    const GnDeviceNeeds needs = needsOfStub();
    REQUIRE(needs.optionalExtensionCount == 3);
    for (int i = 0; i < 3; ++i)
        CHECK(std::string(needs.ppOptionalExtensions[i]) == kRayExtensions[i]);
    CHECK(needs.optional.shaderFloat64 == VK_TRUE);

    // The chain as a host hands it on.
    REQUIRE(needs.pOptionalFeatures);
    VkPhysicalDeviceVulkan12Features features12{};
    features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features12.pNext = const_cast<void*>(needs.pOptionalFeatures);
    features12.bufferDeviceAddress = VK_TRUE;
    const VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, needs.optional};
    const std::vector<std::string> names(std::begin(kRayExtensions), std::end(kRayExtensions));
    CHECK_FALSE(static_cast<bool>(missingForRayQuery(features, names)));

    const auto nothing = [] {
        const GnDeviceNeeds none = needsOfStub();
        return none.optionalExtensionCount == 0 && !none.pOptionalFeatures;
    };
    stub.hasRayQueries = false;
    CHECK(nothing());
    stub.hasRayQueries = true;
    stub.hasBufferDeviceAddress = false;
    CHECK(nothing());
    stub.hasBufferDeviceAddress = true;
    stub.deviceFeatures.shaderFloat64 = VK_FALSE;
    CHECK(nothing());
    stub.deviceFeatures.shaderFloat64 = VK_TRUE;
    CHECK_FALSE(nothing());
    for (std::size_t i = 1; i < stub.deviceExtensions.size(); ++i) {
        const char* left = std::exchange(stub.deviceExtensions[i], "VK_KHR_swapchain");
        CHECK(nothing());
        stub.deviceExtensions[i] = left;
    }
}

TEST_CASE("what a host left out of what rays need is named, and functions that it promised have to be there")
{
    StubVulkan stub;
    Given given;
    VkPhysicalDeviceRayQueryFeaturesKHR query{};
    query.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR;
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{};
    structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
    structures.pNext = &query;
    VkPhysicalDeviceBufferDeviceAddressFeatures address{};
    address.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES;
    address.pNext = &structures;
    VkPhysicalDeviceFeatures2 features = *given.info.pEnabledFeatures;
    auto* last = reinterpret_cast<VkBaseOutStructure*>(&features);
    while (last->pNext)
        last = last->pNext;
    last->pNext = reinterpret_cast<VkBaseOutStructure*>(&address);
    given.info.pEnabledFeatures = &features;
    const auto missing = [&]() -> std::string {
        Result<std::unique_ptr<DeviceTable>> table = loadDeviceTable(given.info);
        REQUIRE(table);
        CHECK((*table)->rayQuery() == !(*table)->rayQueryMissing);
        CHECK(static_cast<bool>((*table)->vkCmdBuildAccelerationStructuresKHR) == (*table)->rayQuery());
        return (*table)->rayQueryMissing ? (*table)->rayQueryMissing : "";
    };
    CHECK(missing() == "needs VK_KHR_acceleration_structure");
    given.info.ppEnabledExtensionNames = kRayExtensions;
    given.info.enabledExtensionCount = 2;
    CHECK(missing() == "needs VK_KHR_ray_query");
    given.info.enabledExtensionCount = 3;
    CHECK(missing() == "needs the feature accelerationStructure of VK_KHR_acceleration_structure");
    structures.accelerationStructure = VK_TRUE;
    CHECK(missing() == "needs the feature rayQuery of VK_KHR_ray_query");
    query.rayQuery = VK_TRUE;
    CHECK(missing() == "needs bufferDeviceAddress");
    address.bufferDeviceAddress = VK_TRUE;
    CHECK(missing() == "needs shaderFloat64");
    features.features.shaderFloat64 = VK_TRUE;
    CHECK(missing().empty());
    stub.absentFunction = "vkCmdBuildAccelerationStructuresKHR";
    checkRefused(given.info, GN_ERROR_FEATURE_MISSING, "vkCmdBuildAccelerationStructuresKHR");
}

TEST_CASE("Vulkan's errors become ours, with the call's name")
{
    CHECK(vulkanError(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2").result == GN_ERROR_DEVICE_LOST);
    CHECK(vulkanError(VK_ERROR_OUT_OF_DEVICE_MEMORY, "x").result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
    CHECK(vulkanError(VK_ERROR_OUT_OF_HOST_MEMORY, "x").result == GN_ERROR_OUT_OF_HOST_MEMORY);
    const Error other = vulkanError(VK_ERROR_FORMAT_NOT_SUPPORTED, "vkCreateImage");
    CHECK(other.result == GN_ERROR_UNKNOWN);
    CHECK(other.text == "vkCreateImage failed: VkResult -11");
}
