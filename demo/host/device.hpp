#pragma once
// A Vulkan instance and device as any host would make them, with what gnomon asks for enabled.

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "demo/host/vulkan.hpp"
#include "gnomon/gnomon.h"
// After vulkan.h, which includes it only with VK_ENABLE_BETA_EXTENSIONS.
#include <vulkan/vulkan_beta.h>

namespace gnomon::demo {

/// VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PORTABILITY_SUBSET_FEATURES_KHR, which vulkan_core.h names only with the same.
inline constexpr auto kPortabilitySubsetFeatures = static_cast<VkStructureType>(1000163000);

struct DeviceOptions {
    bool validation = false; ///< Core and synchronization validation, queue submissions included; an error if absent.
    std::string name;        ///< Part of the device's name; empty: $GNOMON_DEVICE, else the first that can run gnomon.
    std::vector<const char*> instanceExtensions; ///< What the window system asks for; enables VK_KHR_swapchain.
};

/// What the validation layer said. Filled from any thread.
class ValidationLog {
public:
    void add(std::string message);
    std::vector<std::string> messages() const;
    size_t count() const;

private:
    mutable std::mutex mutex_;
    std::vector<std::string> messages_;
};

class Device {
public:
    static std::unique_ptr<Device> create(const DeviceOptions& options);
    /// True where no usable Vulkan device exists at all: tests report themselves as skipped.
    static bool nonePresent();
    static bool validationPresent();

    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
    VkDevice handle = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queueFamily = 0;
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory{};
    std::string driver; ///< "Mesa 22.3.6 (LLVM 15.0.6)".
    ValidationLog validation;

    /// The members of the create-info that speak of the device; the caller adds its own.
    GnContextCreateInfo contextInfo() const;
    uint32_t memoryType(uint32_t allowed, VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred) const;

private:
    Device() = default;
    void createInstance(const DeviceOptions& options);
    void choosePhysicalDevice(const std::string& name);
    void createDevice(bool swapchain);
    void allowQueries();      ///< What tests count by, where the device has it; gnomon asks for none of it.
    void enablePortability(); ///< Where a device lists its subset of Vulkan, that has to be enabled: all it has.

    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    // The chain given to vkCreateDevice: gnomon wants to see it, and Vulkan cannot be asked for it afterwards.
    VkPhysicalDeviceVulkan13Features features13_{};
    VkPhysicalDeviceVulkan12Features features12_{};
    VkPhysicalDevicePortabilitySubsetFeaturesKHR portability_{.sType = kPortabilitySubsetFeatures};
    VkPhysicalDeviceFeatures2 features_{};
    std::vector<const char*> extensions_;
};

} // namespace gnomon::demo
