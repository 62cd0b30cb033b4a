#include "demo/host/readback.hpp"

#include <algorithm>
#include <cstring>

#include "demo/host/pipelines.hpp"
#include "shaders/demo_visibility_copy_comp.h"
#include "shaders/demo_visibility_copy_packed_comp.h"

namespace gnomon::demo {
namespace {

struct CopyPush {
    uint32_t width, height, layers;
};

} // namespace

UniqueSemaphore makeTimeline(const Device& device)
{
    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    vkCheck(vkCreateSemaphore(device.handle, &info, nullptr, &semaphore), "vkCreateSemaphore");
    return {device.handle, semaphore};
}

UniqueSampler makeNearestSampler(const Device& device)
{
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .maxLod = VK_LOD_CLAMP_NONE};
    VkSampler sampler = VK_NULL_HANDLE;
    vkCheck(vkCreateSampler(device.handle, &info, nullptr, &sampler), "vkCreateSampler");
    return {device.handle, sampler};
}

void waitTimeline(const Device& device, VkSemaphore timeline, uint64_t value)
{
    const VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &timeline,
                                   .pValues = &value};
    vkCheck(vkWaitSemaphores(device.handle, &info, UINT64_MAX), "vkWaitSemaphores");
}

Readback::Readback(const Device& device, bool packed)
    : device_(device), timeline_(makeTimeline(device)), sampler_(makeNearestSampler(device))
{
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .queueFamilyIndex = device.queueFamily};
    VkCommandPool pool = VK_NULL_HANDLE;
    vkCheck(vkCreateCommandPool(device.handle, &poolInfo, nullptr, &pool), "vkCreateCommandPool");
    pool_ = {device.handle, pool};
    const VkCommandBufferAllocateInfo cmdInfo{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 1};
    vkCheck(vkAllocateCommandBuffers(device.handle, &cmdInfo, &cmd_), "vkAllocateCommandBuffers");

    const VkDescriptorSetLayoutBinding bindings[] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr}};
    setLayout_ = makeSetLayout(device, bindings);
    const VkDescriptorSetLayout layouts[] = {setLayout_.get()};
    layout_ = makePipelineLayout(device, layouts, sizeof(CopyPush), VK_SHADER_STAGE_COMPUTE_BIT);
    const std::span<const uint32_t> code =
        packed ? std::span<const uint32_t>(k_demo_visibility_copy_packed_comp) : k_demo_visibility_copy_comp;
    pipeline_ = makeComputePipeline(device, code, layout_.get());
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1}};
    const VkDescriptorPoolCreateInfo descriptorInfo{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 2, .pPoolSizes = sizes};
    VkDescriptorPool descriptors = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorPool(device.handle, &descriptorInfo, nullptr, &descriptors), "vkCreateDescriptorPool");
    descriptors_ = {device.handle, descriptors};
    const VkDescriptorSetAllocateInfo setInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = descriptors,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = layouts};
    vkCheck(vkAllocateDescriptorSets(device.handle, &setInfo, &set_), "vkAllocateDescriptorSets");
}

Readback::~Readback()
{
    if (submitted_ > 0) waitTimeline(device_, timeline_.get(), submitted_);
}

VkCommandBuffer Readback::begin()
{
    vkCheck(vkResetCommandPool(device_.handle, pool_.get(), 0), "vkResetCommandPool");
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    vkCheck(vkBeginCommandBuffer(cmd_, &info), "vkBeginCommandBuffer");
    // The buffer was written by the copy before; that the host has waited for it orders nothing on the device.
    cmdMemoryBarrier(
        cmd_, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT},
        {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT});
    return cmd_;
}

void Readback::submitAndWait()
{
    cmdMemoryBarrier(cmd_, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT},
                     {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
    vkCheck(vkEndCommandBuffer(cmd_), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo command{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd_};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = timeline_.get(),
                                       .value = ++submitted_,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &command,
                               .signalSemaphoreInfoCount = 1,
                               .pSignalSemaphoreInfos = &signal};
    vkCheck(vkQueueSubmit2(device_.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
    waitTimeline(device_, timeline_.get(), submitted_);
}

Buffer& Readback::buffer(VkDeviceSize size)
{
    if (buffer_.size < size)
        buffer_ =
            makeBuffer(device_, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true);
    return buffer_;
}

std::vector<std::byte> Readback::image(const Image& image, VkImageLayout layout, uint32_t bytesPerTexel)
{
    const size_t size = size_t(image.extent.width) * image.extent.height * bytesPerTexel;
    Buffer& target = buffer(size);
    VkCommandBuffer cmd = begin();
    const Access shader{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                        VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT, layout};
    const Access copy{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                      VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    const VkImageAspectFlags aspect = aspectOf(image.format);
    const VkImageMemoryBarrier2 toCopy[] = {imageBarrier(image.get(), aspect, shader, copy)};
    cmdBarrier(cmd, toCopy);
    const VkBufferImageCopy region{.imageSubresource = {aspect, 0, 0, 1},
                                   .imageExtent = {image.extent.width, image.extent.height, 1}};
    vkCmdCopyImageToBuffer(cmd, image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.get(), 1, &region);
    const VkImageMemoryBarrier2 back[] = {imageBarrier(image.get(), aspect, copy, shader)};
    cmdBarrier(cmd, back);
    submitAndWait();
    const std::span<std::byte> bytes = target.as<std::byte>().first(size);
    return {bytes.begin(), bytes.end()};
}

std::vector<Image8> Readback::visibility(VkImageView view, VkExtent2D extent, uint32_t layers)
{
    if (layers == 0) return {};
    const size_t layerSize = size_t(extent.width) * extent.height;
    const size_t words = (layerSize * layers + 3) / 4;
    Buffer& target = buffer(words * 4);

    const VkDescriptorImageInfo imageInfo{sampler_.get(), view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const VkDescriptorBufferInfo bufferInfo{target.get(), 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet writes[] = {{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = set_,
                                            .dstBinding = 0,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                            .pImageInfo = &imageInfo},
                                           {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = set_,
                                            .dstBinding = 1,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                            .pBufferInfo = &bufferInfo}};
    vkUpdateDescriptorSets(device_.handle, 2, writes, 0, nullptr); // the last use has been waited for

    VkCommandBuffer cmd = begin();
    const CopyPush push{extent.width, extent.height, layers};
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set_, 0, nullptr);
    vkCmdPushConstants(cmd, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    // 64 a group, in rows, because at most 65 535 groups along an axis are guaranteed.
    const auto groups = static_cast<uint32_t>((words + 63) / 64);
    const uint32_t columns = std::min(groups, 32768u);
    vkCmdDispatch(cmd, columns, (groups + columns - 1) / columns, 1);
    submitAndWait();

    std::vector<Image8> out;
    for (uint32_t layer = 0; layer < layers; ++layer) {
        Image8 image(extent.width, extent.height, 1);
        std::memcpy(image.texels.data(), target.as<uint8_t>().data() + layer * layerSize, layerSize);
        out.push_back(std::move(image));
    }
    return out;
}

} // namespace gnomon::demo
