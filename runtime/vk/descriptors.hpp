#pragma once
// Descriptor sets cached by content, samplers, and the frame's ring of uniform memory.
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "runtime/vk/memory.hpp"
#include "runtime/vk/pipelines.hpp"

namespace gnomon {

/// One resolved binding: handles only.
struct DescriptorWrite {
    std::uint32_t binding = 0;
    BindingKind kind = BindingKind::constants;
    VkImageView view = VK_NULL_HANDLE;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkSampler sampler = VK_NULL_HANDLE;
    VkBuffer buffer = VK_NULL_HANDLE; ///< constants: the ring; the range is `range`, the offset is dynamic.
    VkDeviceSize range = VK_WHOLE_SIZE;
};

/// Sets by (layout, content). When a view or buffer that any set may name is destroyed, forgetAll() starts afresh; the
/// old pools live on until `completedFrame` has passed the frame of the last use.
class DescriptorCache {
public:
    explicit DescriptorCache(const DeviceTable& vk) : vk_(vk) {}
    ~DescriptorCache();
    DescriptorCache(const DescriptorCache&) = delete;
    DescriptorCache& operator=(const DescriptorCache&) = delete;

    Result<VkDescriptorSet> get(VkDescriptorSetLayout layout, std::span<const DescriptorWrite> writes);
    void forgetAll(std::uint64_t frame);
    void retire(std::uint64_t completedFrame) noexcept;

private:
    struct Entry {
        std::uint64_t hash;
        VkDescriptorSetLayout layout;
        std::vector<DescriptorWrite> writes;
        VkDescriptorSet set;
    };
    struct OldPools {
        std::uint64_t frame;
        std::vector<VkDescriptorPool> pools;
    };
    Result<VkDescriptorSet> allocate(VkDescriptorSetLayout layout);

    const DeviceTable& vk_;
    std::unordered_multimap<std::uint64_t, Entry> entries_;
    std::vector<VkDescriptorPool> pools_;
    std::vector<OldPools> old_;
};

class SamplerSet {
public:
    explicit SamplerSet(const DeviceTable& vk) : vk_(vk) {}
    ~SamplerSet();
    Result<void> create();
    VkSampler get(SamplerKind kind) const noexcept { return samplers_[static_cast<std::size_t>(kind)]; }

private:
    const DeviceTable& vk_;
    VkSampler samplers_[5] = {};
};

} // namespace gnomon
