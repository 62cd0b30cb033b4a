#include "device/dispatch.hpp"

#include <array>
#include <set>

#include "demo/host/pipelines.hpp"

namespace gnomon::test {

namespace {

VkDescriptorType typeOf(uint32_t binding)
{
    return binding == 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

constexpr demo::Access kFetched{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                VK_IMAGE_LAYOUT_GENERAL};

demo::Image imageOf(VkCommandBuffer cmd, const Sampled& sampled)
{
    demo::Image image =
        demo::makeImage(device(), {.format = sampled.format,
                                   .extent = sampled.extent,
                                   .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    constexpr demo::Access kCopied{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   VK_IMAGE_LAYOUT_GENERAL};
    constexpr VkImageAspectFlags kColour = VK_IMAGE_ASPECT_COLOR_BIT;
    demo::cmdBarrier(cmd, std::array{demo::imageBarrier(image.get(), kColour, {}, kCopied)});
    const VkBufferImageCopy region{.imageSubresource = {kColour, 0, 0, 1},
                                   .imageExtent = {sampled.extent.width, sampled.extent.height, 1}};
    vkCmdCopyBufferToImage(cmd, sampled.texels->get(), image.get(), kCopied.layout, 1, &region);
    demo::cmdBarrier(cmd, std::array{demo::imageBarrier(image.get(), kColour, kCopied, kFetched)});
    return image;
}

demo::UniqueSampler nearest()
{
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    VkSampler sampler = VK_NULL_HANDLE;
    demo::vkCheck(vkCreateSampler(device().handle, &info, nullptr, &sampler), "vkCreateSampler");
    return {device().handle, sampler};
}

} // namespace

void run(const std::vector<Dispatch>& dispatches)
{
    const demo::Device& gpu = device();
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    uint32_t imageCount = 0;
    std::set<uint32_t> images;
    for (const Dispatch& dispatch : dispatches)
        for (const Sampled& sampled : dispatch.images) {
            ++imageCount;
            images.insert(sampled.binding);
        }
    for (const uint32_t binding : {0u, 1u, 2u, 5u})
        if (!images.contains(binding))
            bindings.push_back({binding, typeOf(binding), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    for (const uint32_t binding : images)
        bindings.push_back(
            {binding, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    const demo::UniqueSetLayout setLayout = demo::makeSetLayout(gpu, bindings);
    const demo::UniquePipelineLayout layout =
        demo::makePipelineLayout(gpu, std::array{setLayout.get()}, 0, VK_SHADER_STAGE_COMPUTE_BIT);
    const auto count = static_cast<uint32_t>(dispatches.size());
    const VkDescriptorPoolSize sizes[] = {{typeOf(0), count},
                                          {typeOf(1), 3 * count},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, imageCount * count + 1}};
    const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                              .maxSets = count,
                                              .poolSizeCount = 3,
                                              .pPoolSizes = sizes};
    VkDescriptorPool poolHandle = VK_NULL_HANDLE;
    demo::vkCheck(vkCreateDescriptorPool(gpu.handle, &poolInfo, nullptr, &poolHandle), "vkCreateDescriptorPool");
    const demo::UniqueDescriptorPool pool(gpu.handle, poolHandle);
    const VkCommandPoolCreateInfo commandsInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                               .queueFamilyIndex = gpu.queueFamily};
    VkCommandPool commandsHandle = VK_NULL_HANDLE;
    demo::vkCheck(vkCreateCommandPool(gpu.handle, &commandsInfo, nullptr, &commandsHandle), "vkCreateCommandPool");
    const demo::UniqueCommandPool commands(gpu.handle, commandsHandle);
    const VkCommandBufferAllocateInfo cmdInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = commands.get(),
                                              .commandBufferCount = 1};
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    demo::vkCheck(vkAllocateCommandBuffers(gpu.handle, &cmdInfo, &cmd), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    demo::vkCheck(vkBeginCommandBuffer(cmd, &begin), "vkBeginCommandBuffer");
    std::vector<demo::UniquePipeline> pipelines;
    std::vector<demo::Image> held;
    const demo::UniqueSampler sampler = nearest();
    for (const Dispatch& dispatch : dispatches) {
        const VkDescriptorSetLayout setLayouts[] = {setLayout.get()};
        const VkDescriptorSetAllocateInfo setInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                                  .descriptorPool = pool.get(),
                                                  .descriptorSetCount = 1,
                                                  .pSetLayouts = setLayouts};
        VkDescriptorSet set = VK_NULL_HANDLE;
        demo::vkCheck(vkAllocateDescriptorSets(gpu.handle, &setInfo, &set), "vkAllocateDescriptorSets");
        for (const auto& [binding, buffer] : dispatch.buffers) {
            const VkDescriptorBufferInfo range{buffer->get(), 0, VK_WHOLE_SIZE};
            const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                             .dstSet = set,
                                             .dstBinding = binding,
                                             .descriptorCount = 1,
                                             .descriptorType = typeOf(binding),
                                             .pBufferInfo = &range};
            vkUpdateDescriptorSets(gpu.handle, 1, &write, 0, nullptr);
        }
        for (const Sampled& sampled : dispatch.images) {
            held.push_back(imageOf(cmd, sampled));
            const VkDescriptorImageInfo image{sampler.get(), held.back().view.get(), kFetched.layout};
            const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                             .dstSet = set,
                                             .dstBinding = sampled.binding,
                                             .descriptorCount = 1,
                                             .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                             .pImageInfo = &image};
            vkUpdateDescriptorSets(gpu.handle, 1, &write, 0, nullptr);
        }
        pipelines.push_back(demo::makeComputePipeline(gpu, dispatch.code, layout.get()));
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines.back().get());
        vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout.get(), 0, 1, &set, 0, nullptr);
        vkCmdDispatch(cmd, dispatch.x, dispatch.y, dispatch.z);
        demo::cmdMemoryBarrier(
            cmd, {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT},
            {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
             VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT});
    }
    demo::vkCheck(vkEndCommandBuffer(cmd), "vkEndCommandBuffer");
    const demo::UniqueSemaphore done = demo::makeTimeline(gpu);
    const VkCommandBufferSubmitInfo command{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = done.get(),
                                       .value = 1,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &command,
                               .signalSemaphoreInfoCount = 1,
                               .pSignalSemaphoreInfos = &signal};
    demo::vkCheck(vkQueueSubmit2(gpu.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
    demo::waitTimeline(gpu, done.get(), 1);
}

} // namespace gnomon::test
