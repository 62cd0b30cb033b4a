#include "device/sampled_support.hpp"

#include <algorithm>
#include <cstring>

namespace gnomon::test {

using namespace demo;

namespace {

VkDescriptorSetLayoutBinding binding(uint32_t number, VkDescriptorType type, uint32_t count = 1)
{
    return {
        .binding = number, .descriptorType = type, .descriptorCount = count, .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
}

VkWriteDescriptorSet write(VkDescriptorSet set, uint32_t number, VkDescriptorType type)
{
    return {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set,
            .dstBinding = number,
            .descriptorCount = 1,
            .descriptorType = type};
}

} // namespace

Sampler::Sampler(std::span<const uint32_t> code)
    : setLayout_(makeSetLayout(device(), std::array{binding(0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER),
                                                    binding(1, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, kLights),
                                                    binding(2, VK_DESCRIPTOR_TYPE_SAMPLER),
                                                    binding(3, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER),
                                                    binding(4, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)})),
      layout_(makePipelineLayout(device(), std::array{setLayout_.get()}, 0, 0)),
      pipeline_(makeComputePipeline(device(), code, layout_.get())), timeline_(makeTimeline(device())),
      constants_(
          makeBuffer(device(), VkDeviceSize{kLights} * GN_SAMPLED_LIGHT_SIZE, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT)),
      question_(makeBuffer(device(), 16, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT))
{
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 2},
                                          {VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, kLights},
                                          {VK_DESCRIPTOR_TYPE_SAMPLER, 1},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1}};
    const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                              .maxSets = 1,
                                              .poolSizeCount = std::size(sizes),
                                              .pPoolSizes = sizes};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorPool(device().handle, &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
    descriptors_ = {device().handle, pool};
    const VkDescriptorSetLayout layout = setLayout_.get();
    const VkDescriptorSetAllocateInfo setInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = pool,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = &layout};
    vkCheck(vkAllocateDescriptorSets(device().handle, &setInfo, &set_), "vkAllocateDescriptorSets");
    const VkCommandPoolCreateInfo commandsInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                               .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                               .queueFamilyIndex = device().queueFamily};
    VkCommandPool commands = VK_NULL_HANDLE;
    vkCheck(vkCreateCommandPool(device().handle, &commandsInfo, nullptr, &commands), "vkCreateCommandPool");
    commands_ = {device().handle, commands};
}

/// The maps are written only when the revision says so, as a host does.
void Sampler::writeSet(const Host& host, uint32_t light, const std::vector<SampledPoint>& points, const double* origin)
{
    host.require(gnGetSampledShadows(host.context, host.views[0], origin, &last));
    REQUIRE(last.constantsStride == GN_SAMPLED_LIGHT_SIZE);
    REQUIRE(last.lightCount <= kLights);
    REQUIRE(last.constantsSize == size_t{last.lightCount} * last.constantsStride);
    std::memset(constants_.mapped, 0, constants_.size);
    std::memcpy(constants_.mapped, last.pConstants, last.constantsSize);
    const uint32_t question[4] = {light, static_cast<uint32_t>(points.size())};
    std::memcpy(question_.mapped, question, sizeof question);
    const VkDeviceSize bytes = points.size() * sizeof(SampledPoint);
    if (points_.size < bytes) points_ = makeBuffer(device(), bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true);
    std::memcpy(points_.mapped, points.data(), bytes);

    const VkDescriptorBufferInfo buffers[] = {
        {constants_.get(), 0, VK_WHOLE_SIZE}, {question_.get(), 0, VK_WHOLE_SIZE}, {points_.get(), 0, VK_WHOLE_SIZE}};
    std::vector<VkWriteDescriptorSet> writes{write(set_, 0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER),
                                             write(set_, 3, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER),
                                             write(set_, 4, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)};
    for (size_t i = 0; i < 3; ++i)
        writes[i].pBufferInfo = &buffers[i];
    const VkDescriptorImageInfo sampler{last.sampler, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED};
    std::array<VkDescriptorImageInfo, kLights> images{};
    const std::vector<VkImageView> now(last.pMaps, last.pMaps + last.lightCount);
    CHECK_MESSAGE((now == bound_ || last.revision > revision_), "maps changed, but the revision did not");
    if (last.revision != revision_) {
        for (uint32_t i = 0; i < kLights; ++i)
            images[i] = {VK_NULL_HANDLE, now[std::min(i, last.lightCount - 1)],
                         VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        writes.push_back(write(set_, 1, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE));
        writes.back().descriptorCount = kLights;
        writes.back().pImageInfo = images.data();
        writes.push_back(write(set_, 2, VK_DESCRIPTOR_TYPE_SAMPLER));
        writes.back().pImageInfo = &sampler;
    }
    revision_ = last.revision;
    bound_ = now;
    vkUpdateDescriptorSets(device().handle, static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

std::vector<float> Sampler::sample(const Host& host, uint32_t light, std::vector<SampledPoint> points,
                                   const double* origin)
{
    writeSet(host, light, points, origin);
    vkCheck(vkResetCommandPool(device().handle, commands_.get(), 0), "vkResetCommandPool");
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = commands_.get(),
                                           .commandBufferCount = 1};
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    vkCheck(vkAllocateCommandBuffers(device().handle, &info, &cmd), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    vkCheck(vkBeginCommandBuffer(cmd, &begin), "vkBeginCommandBuffer");
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set_, 0, nullptr);
    vkCmdDispatch(cmd, static_cast<uint32_t>((points.size() + 63) / 64), 1, 1);
    cmdMemoryBarrier(cmd, {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT},
                     {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
    vkCheck(vkEndCommandBuffer(cmd), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, .commandBuffer = cmd};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = timeline_.get(),
                                       .value = ++submitted_,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &buffer,
                               .signalSemaphoreInfoCount = 1,
                               .pSignalSemaphoreInfos = &signal};
    vkCheck(vkQueueSubmit2(device().queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
    waitTimeline(device(), timeline_.get(), submitted_);
    std::memcpy(points.data(), points_.mapped, points.size() * sizeof(SampledPoint));
    std::vector<float> answers;
    for (const SampledPoint& point : points)
        answers.push_back(point.position.w);
    return answers;
}

} // namespace gnomon::test
