// The device of the stranger's renderer, and images and buffers on it: Vulkan 1.3 as a small renderer writes it, with
// nothing of gnomon's but what gnQueryDeviceNeeds() says.
#ifndef GNOMON_TESTS_HOST_VULKAN_DEVICE_HPP
#define GNOMON_TESTS_HOST_VULKAN_DEVICE_HPP

#include <cstddef>

#include <vulkan/vulkan.h>

namespace stranger {

/// Throws std::runtime_error with the call and the result's number. For results of Vulkan and of gnomon alike.
void check(int result, const char* call);

struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkFormat format = VK_FORMAT_UNDEFINED;
};

/// Host-visible and mapped for as long as it lives.
struct Buffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    void* mapped = nullptr;
};

class Device {
public:
    /// Where there is no Vulkan device that gnomon can run on, `present()` is false and nothing else may be called.
    Device();
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    bool present() const noexcept { return device != VK_NULL_HANDLE; }
    Image createImage(VkFormat format, VkExtent2D size, VkImageUsageFlags usage) const;
    Buffer createBuffer(size_t bytes, VkBufferUsageFlags usage) const;
    void destroy(Image& image) const noexcept;
    void destroy(Buffer& buffer) const noexcept;
    VkShaderModule createShader(const uint32_t* pCode, size_t bytes) const;

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice gpu = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    VkPhysicalDeviceFeatures2 features{}; ///< The chain given to vkCreateDevice.
    double timestampMs = 0.0;             ///< Milliseconds a tick.
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE] = {};

private:
    VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) const;

    VkPhysicalDeviceVulkan13Features features13_{};
    VkPhysicalDeviceVulkan12Features features12_{};
};

/// Everything written before is available to everything after. A small renderer has few barriers and spells them alike.
void barrier(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to,
             uint32_t layers = 1);

} // namespace stranger

#define STRANGER_CHECK(call) ::stranger::check(static_cast<int>(call), #call)

#endif
