#pragma once
// Descriptor sets of one frame slot: handed out in order, rewritten every frame. The slot is only used again when the
// GPU has finished with it, so a set never names something that died, and a steady frame allocates nothing.
#include <span>
#include <unordered_map>
#include <vector>

#include "runtime/vk/memory.hpp"
#include "runtime/vk/pipelines.hpp"

namespace gnomon {

/// Of one pipeline, at most.
inline constexpr std::size_t kMaxBindings = 16;

/// One resolved binding: handles only.
struct DescriptorWrite {
    std::uint32_t binding = 0;
    BindingKind kind = BindingKind::constants;
    VkImageView view = VK_NULL_HANDLE;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkSampler sampler = VK_NULL_HANDLE;
    VkBuffer buffer = VK_NULL_HANDLE; ///< constants: the ring; the offset is dynamic.
    VkDeviceSize range = VK_WHOLE_SIZE;
    VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
    VkDeviceSize offset = 0; ///< Of a storage buffer.
};

class DescriptorRing {
public:
    explicit DescriptorRing(const DeviceTable& vk) : vk_(&vk) {}
    ~DescriptorRing();
    DescriptorRing(const DescriptorRing&) = delete;
    DescriptorRing& operator=(const DescriptorRing&) = delete;

    /// The slot's frame is finished: all sets may be rewritten.
    void begin();
    Result<VkDescriptorSet> next(VkDescriptorSetLayout layout, std::span<const DescriptorWrite> writes);

private:
    struct Sets {
        std::vector<VkDescriptorSet> sets;
        std::size_t used = 0;
    };
    Result<VkDescriptorSet> allocate(VkDescriptorSetLayout layout);

    const DeviceTable* vk_;
    std::unordered_map<VkDescriptorSetLayout, Sets> byLayout_;
    std::vector<VkDescriptorPool> pools_;
    std::uint32_t left_ = 0; ///< Sets that the newest pool has left.
};

} // namespace gnomon
