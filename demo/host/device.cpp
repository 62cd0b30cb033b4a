#include "demo/host/device.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace gnomon::demo {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

// The layer counts handles and reports once; more than this means the log itself is the problem.
constexpr size_t kMaxLoggedMessages = 256;

VKAPI_ATTR VkBool32 VKAPI_CALL onValidationMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                   VkDebugUtilsMessageTypeFlagsEXT,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user)
{
    static_cast<ValidationLog*>(user)->add(data->pMessage ? data->pMessage : "(no text)");
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messengerInfo(ValidationLog& log)
{
    return {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
            .messageSeverity =
                VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
            .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
            .pfnUserCallback = &onValidationMessage,
            .pUserData = &log};
}

// A family with graphics and compute; every implementation with graphics has one.
uint32_t findQueueFamily(VkPhysicalDevice physicalDevice)
{
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &count, families.data());
    constexpr VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < count; ++i)
        if ((families[i].queueFlags & wanted) == wanted) return i;
    throw HostError("the device has no queue for graphics and compute");
}

bool lists(const std::vector<VkExtensionProperties>& extensions, const char* name)
{
    return std::any_of(extensions.begin(), extensions.end(),
                       [name](const auto& extension) { return std::strcmp(extension.extensionName, name) == 0; });
}

// Drivers that map Vulkan onto another API (MoltenVK, Dozen) are shown only to those who ask for them.
VkInstanceCreateFlags askForPortability(std::vector<const char*>& extensions)
{
    uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> present(count);
    vkEnumerateInstanceExtensionProperties(nullptr, &count, present.data());
    if (!lists(present, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) return 0;
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    return VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
}

bool hasGeometryShader(VkPhysicalDevice physicalDevice)
{
    VkPhysicalDeviceFeatures features{};
    vkGetPhysicalDeviceFeatures(physicalDevice, &features);
    return features.geometryShader == VK_TRUE;
}

std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance)
{
    uint32_t count = 0;
    vkCheck(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    vkCheck(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
    devices.resize(count);
    return devices;
}

} // namespace

void ValidationLog::add(std::string message)
{
    const std::lock_guard lock(mutex_);
    if (messages_.size() < kMaxLoggedMessages) messages_.push_back(std::move(message));
}

std::vector<std::string> ValidationLog::messages() const
{
    const std::lock_guard lock(mutex_);
    return messages_;
}

size_t ValidationLog::count() const
{
    const std::lock_guard lock(mutex_);
    return messages_.size();
}

bool Device::validationPresent()
{
    uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(),
                       [](const auto& layer) { return std::strcmp(layer.layerName, kValidationLayer) == 0; });
}

bool Device::nonePresent()
{
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    std::vector<const char*> extensions;
    const VkInstanceCreateFlags flags = askForPortability(extensions);
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .flags = flags,
                                    .pApplicationInfo = &application,
                                    .enabledExtensionCount = static_cast<uint32_t>(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    VkInstance instance = VK_NULL_HANDLE;
    if (vkCreateInstance(&info, nullptr, &instance) != VK_SUCCESS) return true;
    uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance, &count, nullptr);
    vkDestroyInstance(instance, nullptr);
    return count == 0;
}

std::unique_ptr<Device> Device::create(const DeviceOptions& options)
{
    std::unique_ptr<Device> device(new Device);
    device->createInstance(options);
    const char* fromEnvironment = std::getenv("GNOMON_DEVICE");
    device->choosePhysicalDevice(!options.name.empty() ? options.name : fromEnvironment ? fromEnvironment : "");
    device->createDevice(!options.instanceExtensions.empty());
    return device;
}

Device::~Device()
{
    if (handle) {
        vkDeviceWaitIdle(handle);
        vkDestroyDevice(handle, nullptr);
    }
    if (messenger_) {
        const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
        destroy(instance, messenger_, nullptr);
    }
    if (instance) vkDestroyInstance(instance, nullptr);
}

void Device::createInstance(const DeviceOptions& options)
{
    if (options.validation && !validationPresent())
        throw HostError(std::string(kValidationLayer) + " is not installed (Debian: vulkan-validationlayers)");

    // Queue submissions have no bit in VkValidationFeatureEnableEXT of this header; the layer reads them from here.
    // An answer of the user's own stays.
    if (options.validation)
        setenv("VK_LAYER_ENABLES", "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT", 0);

    std::vector<const char*> extensions = options.instanceExtensions;
    if (options.validation) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    const VkInstanceCreateFlags flags = askForPortability(extensions);
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "gnomon demo",
                                        .apiVersion = VK_API_VERSION_1_3};
    VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(validation);
    const VkValidationFeatureEnableEXT enables[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                           .pNext = &messenger, // messages of vkCreateInstance itself
                                           .enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = enables};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = options.validation ? &features : nullptr,
                                    .flags = flags,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = options.validation ? 1u : 0u,
                                    .ppEnabledLayerNames = &kValidationLayer,
                                    .enabledExtensionCount = static_cast<uint32_t>(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    vkCheck(vkCreateInstance(&info, nullptr, &instance), "vkCreateInstance");
    if (options.validation) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
        vkCheck(create(instance, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    }
}

void Device::choosePhysicalDevice(const std::string& name)
{
    std::string seen;
    for (VkPhysicalDevice candidate : physicalDevices(instance)) {
        VkPhysicalDeviceDriverProperties driverProperties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
        VkPhysicalDeviceProperties2 all{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                        .pNext = &driverProperties};
        vkGetPhysicalDeviceProperties2(candidate, &all);
        seen += std::string(seen.empty() ? "" : ", ") + all.properties.deviceName;
        if (std::string_view(all.properties.deviceName).find(name) == std::string_view::npos) continue;
        GnDeviceNeeds needs{};
        if (gnQueryDeviceNeeds(instance, candidate, &vkGetInstanceProcAddr, &needs) != GN_SUCCESS) {
            seen += std::string(" (") + needs.reason + ")";
            continue;
        }
        if (!hasGeometryShader(candidate)) { // gnomon would do without, our fragment shader does not
            seen += " (the device lacks geometryShader, which the demo's normals need)";
            continue;
        }
        physicalDevice = candidate;
        properties = all.properties;
        driver = std::string(driverProperties.driverInfo);
        vkGetPhysicalDeviceMemoryProperties(candidate, &memory);
        return;
    }
    throw HostError("no usable Vulkan device named '" + name + "'; seen: " + (seen.empty() ? "none" : seen));
}

void Device::allowQueries()
{
    VkPhysicalDeviceVulkan12Features present12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 present{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &present12};
    vkGetPhysicalDeviceFeatures2(physicalDevice, &present);
    features_.features.occlusionQueryPrecise = present.features.occlusionQueryPrecise;
    features_.features.pipelineStatisticsQuery = present.features.pipelineStatisticsQuery;
    features12_.hostQueryReset = present12.hostQueryReset;
}

void Device::enablePortability()
{
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physicalDevice, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physicalDevice, nullptr, &count, extensions.data());
    if (!lists(extensions, VK_KHR_PORTABILITY_SUBSET_EXTENSION_NAME)) return;
    extensions_.push_back(VK_KHR_PORTABILITY_SUBSET_EXTENSION_NAME);
    VkPhysicalDeviceFeatures2 present{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &portability_};
    vkGetPhysicalDeviceFeatures2(physicalDevice, &present);
    portability_.pNext = features_.pNext;
    features_.pNext = &portability_;
}

void Device::createDevice(bool swapchain)
{
    GnDeviceNeeds needs{};
    gnQueryDeviceNeeds(instance, physicalDevice, &vkGetInstanceProcAddr, &needs);
    if (std::getenv("GNOMON_NO_EXTENSIONS")) {
        needs.optionalExtensionCount = 0;
        needs.pOptionalFeatures = nullptr;
    }
    extensions_.assign(needs.ppOptionalExtensions, needs.ppOptionalExtensions + needs.optionalExtensionCount);
    if (swapchain) extensions_.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);

    features13_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                   .synchronization2 = VK_TRUE,
                   .dynamicRendering = VK_TRUE};
    features12_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                   .pNext = &features13_,
                   .timelineSemaphore = VK_TRUE};
    features_ = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &features12_, .features = needs.optional};
    features_.features.geometryShader = VK_TRUE; // gl_PrimitiveID in our fragment shader: the triangle's normal
    allowQueries();
    enablePortability();
    features12_.bufferDeviceAddress = needs.pOptionalFeatures != nullptr;
    features13_.pNext = const_cast<void*>(needs.pOptionalFeatures); // the end of the chain, which nobody writes

    queueFamily = findQueueFamily(physicalDevice);
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queueInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                            .queueFamilyIndex = queueFamily,
                                            .queueCount = 1,
                                            .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features_,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queueInfo,
                                  .enabledExtensionCount = static_cast<uint32_t>(extensions_.size()),
                                  .ppEnabledExtensionNames = extensions_.data()};
    vkCheck(vkCreateDevice(physicalDevice, &info, nullptr, &handle), "vkCreateDevice");
    vkGetDeviceQueue(handle, queueFamily, 0, &queue);
}

GnContextCreateInfo Device::contextInfo() const
{
    GnContextCreateInfo info{};
    info.instance = instance;
    info.physicalDevice = physicalDevice;
    info.device = handle;
    info.queue = queue;
    info.queueFamilyIndex = queueFamily;
    info.apiVersion = VK_API_VERSION_1_3;
    info.pEnabledFeatures = &features_;
    info.enabledExtensionCount = static_cast<uint32_t>(extensions_.size());
    info.ppEnabledExtensionNames = extensions_.data();
    info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
    if (std::getenv("GNOMON_DEVICE_RAYS")) info.flags |= GN_CONTEXT_DEVICE_RAYS_BIT;
    return info;
}

uint32_t Device::memoryType(uint32_t allowed, VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred) const
{
    for (const VkMemoryPropertyFlags flags : {wanted | preferred, wanted})
        for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
            if ((allowed >> i & 1u) && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    throw HostError("no memory type fits");
}

} // namespace gnomon::demo
