// Which device the program takes and what it asks of it. This executable's own Vulkan functions stand before the
// loader's: the device has less, or another kind of driver.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <dlfcn.h>

#include "demo/host/device.hpp"

namespace {

struct Pretended {
    bool withoutGeometryShader = false;
    bool subset = false; ///< The device lists VK_KHR_portability_subset.
    // What was asked for last.
    VkInstanceCreateFlags instanceFlags = 0;
    bool subsetEnabled = false, subsetFeatures = false;
} pretended;

template <typename Function>
Function* loaders(const char* name, Function*)
{
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" {

VKAPI_ATTR void VKAPI_CALL vkGetPhysicalDeviceFeatures(VkPhysicalDevice device, VkPhysicalDeviceFeatures* features)
{
    loaders("vkGetPhysicalDeviceFeatures", &vkGetPhysicalDeviceFeatures)(device, features);
    if (pretended.withoutGeometryShader) features->geometryShader = VK_FALSE;
}

VKAPI_ATTR VkResult VKAPI_CALL vkCreateInstance(const VkInstanceCreateInfo* info,
                                                const VkAllocationCallbacks* allocator, VkInstance* instance)
{
    pretended.instanceFlags = info->flags;
    return loaders("vkCreateInstance", &vkCreateInstance)(info, allocator, instance);
}

VKAPI_ATTR VkResult VKAPI_CALL vkEnumerateDeviceExtensionProperties(VkPhysicalDevice device, const char* layer,
                                                                    uint32_t* count, VkExtensionProperties* extensions)
{
    const auto real = loaders("vkEnumerateDeviceExtensionProperties", &vkEnumerateDeviceExtensionProperties);
    if (!pretended.subset) return real(device, layer, count, extensions);
    const uint32_t room = *count;
    const VkResult result = real(device, layer, count, extensions);
    if (extensions && *count < room) {
        extensions[*count] = {};
        std::strcpy(extensions[*count].extensionName, VK_KHR_PORTABILITY_SUBSET_EXTENSION_NAME);
    }
    ++*count;
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL vkCreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                              const VkAllocationCallbacks* allocator, VkDevice* device)
{
    std::vector<const char*> names(info->ppEnabledExtensionNames,
                                   info->ppEnabledExtensionNames + info->enabledExtensionCount);
    const size_t erased = std::erase_if(
        names, [](const char* name) { return std::strcmp(name, VK_KHR_PORTABILITY_SUBSET_EXTENSION_NAME) == 0; });
    pretended.subsetEnabled = erased == 1;
    pretended.subsetFeatures = false;
    for (auto* at = static_cast<const VkBaseInStructure*>(info->pNext); at; at = at->pNext)
        pretended.subsetFeatures |= at->sType == gnomon::demo::kPortabilitySubsetFeatures;
    VkDeviceCreateInfo known = *info; // the driver has no such extension; it passes over structures it does not know
    known.enabledExtensionCount = static_cast<uint32_t>(names.size());
    known.ppEnabledExtensionNames = names.data();
    return loaders("vkCreateDevice", &vkCreateDevice)(physical, &known, allocator, device);
}

} // extern "C"

namespace gnomon::demo {

TEST_CASE("a device without geometry shaders is passed over, and the reason given")
{
    pretended = {.withoutGeometryShader = true};
    std::string said;
    try {
        (void)Device::create({});
    } catch (const HostError& error) {
        said = error.what();
    }
    CHECK_MESSAGE(said.find("no usable Vulkan device") != std::string::npos, said);
    CHECK_MESSAGE(said.find("lacks geometryShader") != std::string::npos, said);
    pretended = {};
}

TEST_CASE("drivers that map Vulkan onto another API are asked for, and the subset they list is enabled")
{
    for (const bool subset : {false, true}) {
        CAPTURE(subset);
        pretended = {.subset = subset};
        const std::unique_ptr<Device> device = Device::create({});
        CHECK((pretended.instanceFlags & VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR) != 0);
        CHECK(pretended.subsetEnabled == subset);
        CHECK(pretended.subsetFeatures == subset);
        GnContext context = VK_NULL_HANDLE;
        const GnContextCreateInfo info = device->contextInfo(); // gnomon reads the same chain
        CHECK(gnCreateContext(&info, &context) == GN_SUCCESS);
        gnDestroyContext(context);
    }
    pretended = {};
    CHECK(!Device::nonePresent());
    CHECK((pretended.instanceFlags & VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR) != 0);
    pretended = {};
}

} // namespace gnomon::demo
