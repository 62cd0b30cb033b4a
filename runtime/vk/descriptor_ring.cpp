#include "runtime/vk/descriptor_ring.hpp"

#include <algorithm>
#include <array>

#include "runtime/vk/descriptors.hpp"

namespace gnomon {

namespace {

constexpr std::uint32_t kSetsPerPool = 128;

} // namespace

DescriptorRing::~DescriptorRing()
{
    for (VkDescriptorPool pool : pools_)
        vk_->vkDestroyDescriptorPool(vk_->device, pool, vk_->hostAllocator);
}

void DescriptorRing::begin()
{
    for (auto& [layout, sets] : byLayout_)
        sets.used = 0;
}

Result<VkDescriptorSet> DescriptorRing::allocate(VkDescriptorSetLayout layout)
{
    VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                     .descriptorPool = pools_.empty() ? VK_NULL_HANDLE : pools_.back(),
                                     .descriptorSetCount = 1,
                                     .pSetLayouts = &layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    if (left_ > 0 && vk_->vkAllocateDescriptorSets(vk_->device, &info, &set) == VK_SUCCESS) {
        --left_;
        return set;
    }

    const std::array sizes = {
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, kSetsPerPool},
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kSetsPerPool * 4},
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, kSetsPerPool},
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsPerPool * 4},
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, kSetsPerPool}, // last
    };
    const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                              .maxSets = kSetsPerPool,
                                              .poolSizeCount =
                                                  static_cast<std::uint32_t>(sizes.size()) - !vk_->rayQuery(),
                                              .pPoolSizes = sizes.data()};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    if (VkResult r = vk_->vkCreateDescriptorPool(vk_->device, &poolInfo, vk_->hostAllocator, &pool); r != VK_SUCCESS)
        return vulkanError(r, "vkCreateDescriptorPool");
    ++vk_->objectsMade;
    pools_.push_back(pool);
    left_ = kSetsPerPool - 1;
    info.descriptorPool = pool;
    if (VkResult r = vk_->vkAllocateDescriptorSets(vk_->device, &info, &set); r != VK_SUCCESS)
        return vulkanError(r, "vkAllocateDescriptorSets");
    return set;
}

Result<VkDescriptorSet> DescriptorRing::next(VkDescriptorSetLayout layout, std::span<const DescriptorWrite> writes)
{
    Sets& sets = byLayout_[layout];
    if (sets.used == sets.sets.size()) {
        Result<VkDescriptorSet> made = allocate(layout);
        if (!made) return made.error();
        sets.sets.push_back(*made);
    }
    const VkDescriptorSet set = sets.sets[sets.used++];

    std::array<VkWriteDescriptorSet, kMaxBindings> updates;
    std::array<VkDescriptorImageInfo, kMaxBindings> images;
    std::array<VkDescriptorBufferInfo, kMaxBindings> buffers;
    std::array<VkWriteDescriptorSetAccelerationStructureKHR, kMaxBindings> structures;
    const std::size_t count = std::min(writes.size(), kMaxBindings);
    for (std::size_t i = 0; i < count; ++i) {
        const DescriptorWrite& write = writes[i];
        images[i] = {write.sampler, write.view, write.layout};
        buffers[i] = {write.buffer, write.offset, write.range};
        structures[i] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR,
                         .accelerationStructureCount = 1,
                         .pAccelerationStructures = &write.structure};
        updates[i] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                      .pNext = write.kind == BindingKind::structure ? &structures[i] : nullptr,
                      .dstSet = set,
                      .dstBinding = write.binding,
                      .descriptorCount = 1,
                      .descriptorType = descriptorTypeOf(write.kind),
                      .pImageInfo = &images[i],
                      .pBufferInfo = &buffers[i]};
    }
    vk_->vkUpdateDescriptorSets(vk_->device, static_cast<std::uint32_t>(count), updates.data(), 0, nullptr);
    return set;
}

} // namespace gnomon
