#include "runtime/vk/descriptors.hpp"

#include <iterator>

namespace gnomon {
namespace {

VkSamplerCreateInfo samplerInfo(SamplerKind kind)
{
    const VkSamplerAddressMode address =
        kind == SamplerKind::nearest ? VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
    // No image has a second level; equal limits of levels, both 0, spare a software device their arithmetic.
    return {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
            .magFilter = VK_FILTER_NEAREST,
            .minFilter = VK_FILTER_NEAREST,
            .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
            .addressModeU = address,
            .addressModeV = address,
            .addressModeW = address,
            .maxAnisotropy = 1.0f,
            .borderColor = VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE}; // depth 1: far, lit
}

} // namespace

VkDescriptorType descriptorTypeOf(BindingKind kind) noexcept
{
    switch (kind) {
    case BindingKind::constants:
        return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC;
    case BindingKind::sampledImage:
        return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    case BindingKind::storageImage:
        return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case BindingKind::structure:
        return VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
    case BindingKind::storageBuffer:
        break;
    }
    return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

SamplerSet::~SamplerSet()
{
    for (VkSampler sampler : samplers_)
        if (sampler) vk_.vkDestroySampler(vk_.device, sampler, vk_.hostAllocator);
}

Result<void> SamplerSet::create()
{
    for (std::size_t i = 0; i < std::size(samplers_); ++i) {
        const VkSamplerCreateInfo info = samplerInfo(static_cast<SamplerKind>(i));
        const VkResult result = vk_.vkCreateSampler(vk_.device, &info, vk_.hostAllocator, &samplers_[i]);
        if (result != VK_SUCCESS) {
            samplers_[i] = VK_NULL_HANDLE;
            return vulkanError(result, "vkCreateSampler");
        }
        ++vk_.objectsMade;
    }
    return {};
}

} // namespace gnomon
