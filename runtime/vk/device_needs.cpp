#include <algorithm>
#include <iterator>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/base/struct_size.hpp"
#include "runtime/vk/device_table.hpp"

namespace gnomon {
namespace {

struct InstanceFunctions {
    PFN_vkGetPhysicalDeviceProperties2 properties = nullptr;
    PFN_vkGetPhysicalDeviceFeatures2 features = nullptr;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties2 queueFamilies = nullptr;
    PFN_vkEnumerateDeviceExtensionProperties extensions = nullptr;

    bool load(VkInstance instance, PFN_vkGetInstanceProcAddr get) noexcept
    {
        properties =
            reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(get(instance, "vkGetPhysicalDeviceProperties2"));
        features = reinterpret_cast<PFN_vkGetPhysicalDeviceFeatures2>(get(instance, "vkGetPhysicalDeviceFeatures2"));
        queueFamilies = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties2>(
            get(instance, "vkGetPhysicalDeviceQueueFamilyProperties2"));
        extensions = reinterpret_cast<PFN_vkEnumerateDeviceExtensionProperties>(
            get(instance, "vkEnumerateDeviceExtensionProperties"));
        return properties && features && queueFamilies && extensions;
    }
};

bool hasGraphicsAndCompute(const InstanceFunctions& vk, VkPhysicalDevice device)
{
    std::uint32_t count = 0;
    vk.queueFamilies(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties2> families(
        count, {.sType = VK_STRUCTURE_TYPE_QUEUE_FAMILY_PROPERTIES_2, .pNext = nullptr, .queueFamilyProperties = {}});
    vk.queueFamilies(device, &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    return std::any_of(families.begin(), families.end(), [](const VkQueueFamilyProperties2& family) {
        return (family.queueFamilyProperties.queueFlags & kNeeded) == kNeeded;
    });
}

/// Core features that make more methods eligible, as far as the device has them.
VkPhysicalDeviceFeatures usefulFeatures(const VkPhysicalDeviceFeatures& has)
{
    VkPhysicalDeviceFeatures useful{};
    useful.depthClamp = has.depthClamp;                 // casters in front of the near plane; z-fail volumes
    useful.geometryShader = has.geometryShader;         // gl_PrimitiveID in fragment shaders
    useful.shaderClipDistance = has.shaderClipDistance; // paraboloid halves
    useful.fragmentStoresAndAtomics = has.fragmentStoresAndAtomics; // lists of pixels made by fragment passes
    useful.shaderFloat64 = has.shaderFloat64;                       // rays that start on long triangles
    return useful;
}

// What rays on the device need; the second depends on the first. Appended to the host's chain as they are.
constexpr const char* kRayExtensions[] = {VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                          VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                          VK_KHR_RAY_QUERY_EXTENSION_NAME};
const VkPhysicalDeviceRayQueryFeaturesKHR kRayQuery{
    .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR, .pNext = nullptr, .rayQuery = VK_TRUE};
const VkPhysicalDeviceAccelerationStructureFeaturesKHR kRayFeatures{
    .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
    .pNext = const_cast<VkPhysicalDeviceRayQueryFeaturesKHR*>(&kRayQuery), // which nobody writes: a chain that is given
    .accelerationStructure = VK_TRUE,
    .descriptorBindingAccelerationStructureUpdateAfterBind = VK_FALSE};

/// Whether the device lists all of kRayExtensions.
bool listsRays(const InstanceFunctions& vk, VkPhysicalDevice device)
{
    std::uint32_t count = 0;
    if (vk.extensions(device, nullptr, &count, nullptr) < 0) return false;
    std::vector<VkExtensionProperties> listed(count);
    if (vk.extensions(device, nullptr, &count, listed.data()) < 0) return false;
    return std::ranges::all_of(kRayExtensions, [&listed](std::string_view name) {
        return std::ranges::any_of(listed, [name](const auto& extension) { return name == extension.extensionName; });
    });
}

/// Fills in what rays need, where the device has all of it.
void fillRayNeeds(const InstanceFunctions& vk, VkPhysicalDevice device, GnDeviceNeeds& needs)
{
    if (!listsRays(vk, device)) return; // the structures may be passed only to devices that know them
    VkPhysicalDeviceRayQueryFeaturesKHR query{};
    query.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR;
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{};
    structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
    structures.pNext = &query;
    VkPhysicalDeviceVulkan12Features features12{};
    features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features12.pNext = &structures;
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, {}};
    vk.features(device, &features);
    const std::vector<std::string> all(std::begin(kRayExtensions), std::end(kRayExtensions));
    if (missingForRayQuery(features, all)) return;
    for (const char* name : kRayExtensions)
        needs.ppOptionalExtensions[needs.optionalExtensionCount++] = name;
    needs.pOptionalFeatures = &kRayFeatures;
}

/// Why the device cannot run gnomon, or nothing.
std::string fillNeeds(VkInstance instance, VkPhysicalDevice device, PFN_vkGetInstanceProcAddr get, GnDeviceNeeds& needs)
{
    InstanceFunctions vk;
    if (!vk.load(instance, get)) return "the instance is older than Vulkan 1.1";
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, nullptr, {}};
    vk.properties(device, &properties);
    const std::uint32_t version = properties.properties.apiVersion;
    // The structures of 1.2 and 1.3 may be passed only to devices that know them.
    if (version < VK_API_VERSION_1_3)
        return "the device offers Vulkan " + std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
               std::to_string(VK_API_VERSION_MINOR(version)) + "; gnomon needs 1.3";
    VkPhysicalDeviceVulkan13Features features13{};
    features13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    VkPhysicalDeviceVulkan12Features features12{};
    features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features12.pNext = &features13;
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, {}};
    vk.features(device, &features);
    needs.optional = usefulFeatures(features.features);
    fillRayNeeds(vk, device, needs);
    if (const char* missing = missingFeature(features)) return std::string("the device lacks ") + missing;
    if (!hasGraphicsAndCompute(vk, device)) return "no queue family does both graphics and compute";
    return {};
}

} // namespace
} // namespace gnomon

extern "C" GnResult GN_CALL gnQueryDeviceNeeds(VkInstance instance, VkPhysicalDevice physicalDevice,
                                               PFN_vkGetInstanceProcAddr pfnGetInstanceProcAddr, GnDeviceNeeds* pNeeds)
{
    if (!pNeeds) return GN_ERROR_NULL_ARGUMENT;
    const gnomon::StructArray<GnDeviceNeeds> out(pNeeds, 1);
    if (!out.fits()) return GN_ERROR_OUT_OF_RANGE;
    out.put(0, {});
    if (!instance || !physicalDevice || !pfnGetInstanceProcAddr) return GN_ERROR_NULL_ARGUMENT;
    GnDeviceNeeds needs{.apiVersion = VK_API_VERSION_1_3};
    try {
        const std::string reason = gnomon::fillNeeds(instance, physicalDevice, pfnGetInstanceProcAddr, needs);
        needs.supported = reason.empty();
        reason.copy(needs.reason, sizeof(needs.reason) - 1);
        out.put(0, needs);
        return reason.empty() ? GN_SUCCESS : GN_ERROR_FEATURE_MISSING;
    } catch (const std::bad_alloc&) {
        return GN_ERROR_OUT_OF_HOST_MEMORY;
    } catch (...) {
        return GN_ERROR_UNKNOWN;
    }
}
