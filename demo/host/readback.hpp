#pragma once
// Images back on the CPU. Each call submits a copy and waits for that copy, never for the device to be idle.

#include <span>
#include <vector>

#include "demo/host/device.hpp"
#include "demo/io/image.hpp"

namespace gnomon::demo {

class Readback {
public:
    /// @param packed Visibility is of views with GN_VIEW_PACKED_BIT.
    explicit Readback(const Device& device, bool packed = false);
    ~Readback();

    /// The image is in `layout` before and after. \return its texels, row by row, tightly packed.
    std::vector<std::byte> image(const Image& image, VkImageLayout layout, uint32_t bytesPerTexel);

    /// Layers of a visibility array, through gnomon/visibility.glsl.
    std::vector<Image8> visibility(VkImageView view, VkExtent2D extent, uint32_t layers);

private:
    VkCommandBuffer begin();
    void submitAndWait();
    Buffer& buffer(VkDeviceSize size);

    const Device& device_;
    UniqueCommandPool pool_;
    VkCommandBuffer cmd_ = VK_NULL_HANDLE;
    UniqueSemaphore timeline_;
    uint64_t submitted_ = 0;
    Buffer buffer_;
    UniqueSetLayout setLayout_;
    UniquePipelineLayout layout_;
    UniquePipeline pipeline_;
    UniqueSampler sampler_;
    UniqueDescriptorPool descriptors_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

UniqueSemaphore makeTimeline(const Device& device);
UniqueSampler makeNearestSampler(const Device& device);
void waitTimeline(const Device& device, VkSemaphore timeline, uint64_t value);

} // namespace gnomon::demo
