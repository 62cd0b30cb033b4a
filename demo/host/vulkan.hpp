#pragma once
// The little Vulkan the demo needs: errors as exceptions, owners of handles, buffers and images with memory of their
// own, barriers. The demo is a host, so it links the loader; the library it embeds does not.

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <vulkan/vulkan.h>

#include "demo/io/outcome.hpp"

namespace gnomon::demo {

/// A failure of the host's own; main() turns it into a message and an exit code.
struct HostError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws HostError naming the call; positive results (VK_SUBOPTIMAL_KHR, VK_TIMEOUT) pass.
void vkCheck(VkResult result, const char* call);

template <typename T>
T valueOf(Outcome<T> outcome)
{
    if (!outcome) throw HostError(outcome.error());
    return std::move(*outcome);
}
inline void expect(const Status& status)
{
    if (!status) throw HostError(status.error());
}

/// Owns one handle made from a device or an instance. It knows how to destroy and how to move; nothing else.
template <typename Handle, auto Destroy, typename Maker = VkDevice>
class Unique {
public:
    Unique() = default;
    Unique(Maker maker, Handle handle) noexcept : maker_(maker), handle_(handle) {}
    Unique(Unique&& other) noexcept { swap(other); }
    Unique& operator=(Unique other) noexcept
    {
        swap(other);
        return *this;
    }
    ~Unique()
    {
        if (handle_ != VK_NULL_HANDLE) Destroy(maker_, handle_, nullptr);
    }

    Handle get() const noexcept { return handle_; }

private:
    void swap(Unique& other) noexcept
    {
        std::swap(maker_, other.maker_);
        std::swap(handle_, other.handle_);
    }
    Maker maker_ = VK_NULL_HANDLE;
    Handle handle_ = VK_NULL_HANDLE;
};

using UniqueBuffer = Unique<VkBuffer, &vkDestroyBuffer>;
using UniqueImage = Unique<VkImage, &vkDestroyImage>;
using UniqueImageView = Unique<VkImageView, &vkDestroyImageView>;
using UniqueMemory = Unique<VkDeviceMemory, &vkFreeMemory>;
using UniqueSampler = Unique<VkSampler, &vkDestroySampler>;
using UniqueSemaphore = Unique<VkSemaphore, &vkDestroySemaphore>;
using UniqueCommandPool = Unique<VkCommandPool, &vkDestroyCommandPool>;
using UniqueSetLayout = Unique<VkDescriptorSetLayout, &vkDestroyDescriptorSetLayout>;
using UniqueDescriptorPool = Unique<VkDescriptorPool, &vkDestroyDescriptorPool>;
using UniquePipelineLayout = Unique<VkPipelineLayout, &vkDestroyPipelineLayout>;
using UniquePipeline = Unique<VkPipeline, &vkDestroyPipeline>;
using UniqueSwapchain = Unique<VkSwapchainKHR, &vkDestroySwapchainKHR>;
using UniqueSurface = Unique<VkSurfaceKHR, &vkDestroySurfaceKHR, VkInstance>;

class Device;

/// A buffer in host-visible memory, mapped for life. Members in the order of their destruction, last first.
struct Buffer {
    UniqueMemory memory;
    UniqueBuffer buffer;
    void* mapped = nullptr;
    VkDeviceSize size = 0;

    VkBuffer get() const noexcept { return buffer.get(); }
    template <typename T>
    std::span<T> as() const
    {
        return {static_cast<T*>(mapped), size / sizeof(T)};
    }
};

/// A 2D image in device memory with a view of all its layers.
struct Image {
    UniqueMemory memory;
    UniqueImage image;
    UniqueImageView view;
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    uint32_t layers = 1;

    VkImage get() const noexcept { return image.get(); }
};

struct ImageDescription {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    uint32_t layers = 1;
    bool arrayView = false; ///< A 2D array view even for one layer.
    VkImageUsageFlags usage = 0;
    uint32_t samples = 1;
};

/// `cached`: for the CPU to read back; otherwise for the CPU to write and the device to read.
Buffer makeBuffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage, bool cached = false);
Image makeImage(const Device& device, const ImageDescription& description);

/// All aspects of the format.
VkImageAspectFlags aspectOf(VkFormat format) noexcept;

/// One access of a barrier.
struct Access {
    VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_NONE;
    VkAccessFlags2 access = VK_ACCESS_2_NONE;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< Images only.
};

VkImageMemoryBarrier2 imageBarrier(VkImage image, VkImageAspectFlags aspect, const Access& before, const Access& after);
void cmdBarrier(VkCommandBuffer cmd, std::span<const VkImageMemoryBarrier2> images);
void cmdMemoryBarrier(VkCommandBuffer cmd, const Access& before, const Access& after);
void cmdSetArea(VkCommandBuffer cmd, VkExtent2D extent);

} // namespace gnomon::demo
