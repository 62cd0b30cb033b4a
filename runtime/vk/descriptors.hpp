#pragma once
// What shader bindings are to Vulkan: descriptor types and the samplers that all methods share.
#include "runtime/vk/descriptor_ring.hpp"
#include "runtime/vk/memory.hpp"
#include "runtime/vk/pipelines.hpp"

namespace gnomon {

VkDescriptorType descriptorTypeOf(BindingKind kind) noexcept;

class SamplerSet {
public:
    explicit SamplerSet(const DeviceTable& vk) : vk_(vk) {}
    ~SamplerSet();
    SamplerSet(const SamplerSet&) = delete;
    SamplerSet& operator=(const SamplerSet&) = delete;

    Result<void> create();
    VkSampler get(SamplerKind kind) const noexcept { return samplers_[static_cast<std::size_t>(kind)]; }

private:
    const DeviceTable& vk_;
    VkSampler samplers_[2] = {};
};

} // namespace gnomon
