#include "renderer.hpp"

#include <cstring>

namespace stranger {
namespace {

constexpr VkImageAspectFlags kColour = VK_IMAGE_ASPECT_COLOR_BIT, kDepth = VK_IMAGE_ASPECT_DEPTH_BIT;
constexpr VkImageLayout kUnknown = VK_IMAGE_LAYOUT_UNDEFINED, kTarget = VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL,
                        kReadable = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                        kCopied = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;

double millisecondsSince(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void begin(VkCommandBuffer commands)
{
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    STRANGER_CHECK(vkBeginCommandBuffer(commands, &info));
}

/// Cleared to zero (which is infinitely far in reversed depth), and kept.
VkRenderingAttachmentInfo target(const Image& image)
{
    return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = image.view,
            .imageLayout = kTarget,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
}
} // namespace

void Renderer::drawSurfaces(VkCommandBuffer commands, const Slot& slot) const
{
    barrier(commands, albedo_.image, kColour, kUnknown, kTarget);
    barrier(commands, normals_.image, kColour, kUnknown, kTarget);
    barrier(commands, depth_.image, kDepth, kUnknown, kTarget);
    const VkRenderingAttachmentInfo colours[] = {target(albedo_), target(normals_)}, depth = target(depth_);
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = {{0, 0}, options_.size},
                               .layerCount = 1,
                               .colorAttachmentCount = 2,
                               .pColorAttachments = colours,
                               .pDepthAttachment = &depth};
    const VkDeviceSize start = 0;
    vkCmdBeginRendering(commands, &info);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, surfacePipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelineLayout_, 0, 1, slot.sets.data(), 0,
                            nullptr);
    vkCmdBindVertexBuffers(commands, 0, 1, &vertices_.buffer, &start);
    vkCmdDraw(commands, vertexCount_, 1, 0, 0);
    vkCmdEndRendering(commands);
    barrier(commands, albedo_.image, kColour, kTarget, kReadable);
    barrier(commands, normals_.image, kColour, kTarget, kReadable);
    barrier(commands, depth_.image, kDepth, kTarget, kReadable);
}

void Renderer::drawLighting(VkCommandBuffer commands, const Slot& slot) const
{
    barrier(commands, picture_.image, kColour, kUnknown, kTarget);
    const VkRenderingAttachmentInfo picture = target(picture_);
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = {{0, 0}, options_.size},
                               .layerCount = 1,
                               .colorAttachmentCount = 1,
                               .pColorAttachments = &picture};
    vkCmdBeginRendering(commands, &info);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, lightingPipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelineLayout_, 0, 2, slot.sets.data(), 0,
                            nullptr);
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRendering(commands);
    barrier(commands, picture_.image, kColour, kTarget, kCopied);
}

void Renderer::submit(VkCommandBuffer commands, uint64_t signalled) const
{
    STRANGER_CHECK(vkEndCommandBuffer(commands));
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = commands};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = timeline_,
                                       .value = signalled,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &buffer,
                             .signalSemaphoreInfoCount = signalled ? 1u : 0u,
                             .pSignalSemaphoreInfos = &signal};
    STRANGER_CHECK(vkQueueSubmit2(device_.queue, 1, &info, VK_NULL_HANDLE));
}

void Renderer::collect(Slot& slot)
{
    if (!slot.frame) return;
    const VkSemaphoreWaitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &timeline_,
                                   .pValues = &slot.frame};
    STRANGER_CHECK(vkWaitSemaphores(device_.device, &wait, UINT64_MAX));
    uint64_t ticks[2] = {};
    const uint32_t first = 2 * static_cast<uint32_t>(&slot - slots_.data());
    STRANGER_CHECK(vkGetQueryPoolResults(device_.device, queries_, first, 2, sizeof ticks, ticks, sizeof ticks[0],
                                         VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
    FrameReport& report = reports_[slot.frame - 1];
    report.shadowMs = static_cast<double>(ticks[1] - ticks[0]) * device_.timestampMs;
    if (options_.recorded) report.shadowMs += report.callMs;
    completed_ = slot.frame;
    slot.frame = 0;
}

void Renderer::closeWall()
{
    if (wallOpen_) reports_.back().wallMs = millisecondsSince(wallStart_);
    wallOpen_ = false;
}

void Renderer::renderFrame(double seconds)
{
    closeWall();
    wallStart_ = Clock::now();
    wallOpen_ = true;
    Slot& slot = slots_[reports_.size() % slots_.size()];
    collect(slot);
    reports_.emplace_back();
    const uint64_t frame = reports_.size();
    const uint32_t firstQuery = 2 * static_cast<uint32_t>(&slot - slots_.data());
    data_ = frameDataAt(seconds, static_cast<float>(options_.size.width) / static_cast<float>(options_.size.height));
    std::memcpy(slot.frameData.mapped, &data_, sizeof data_);

    VkCommandBuffer commands = slot.commands[0];
    begin(commands);
    vkCmdResetQueryPool(commands, queries_, firstQuery, 2);
    drawSurfaces(commands, slot);
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_, firstQuery);
    if (!options_.recorded) submit(commands, 0);

    const auto callStart = Clock::now();
    const GnResult result =
        shadows_.render(options_.recorded ? commands : VK_NULL_HANDLE, data_, depth_, normals_, frame, completed_);
    FrameReport& report = reports_.back();
    report.callMs = millisecondsSince(callStart);
    report.result = result;
    report.choices = shadows_.choices();
    const GnFrameStats stats = shadows_.stats();
    report.predictedMs = static_cast<double>(stats.predictedMs);
    if (stats.gpuFrame > 0 && stats.gpuFrame <= frame)
        reports_[stats.gpuFrame - 1].gnomonMs = static_cast<double>(stats.gpuMs + stats.gpuFrameCpuMs);

    nameVisibility(slot);
    if (!options_.recorded) {
        commands = slot.commands[1];
        begin(commands);
    }
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_, firstQuery + 1);
    drawLighting(commands, slot);
    submit(commands, frame);
    slot.frame = frame;
}

void Renderer::finish()
{
    const size_t oldest = reports_.size() % slots_.size();
    for (size_t i = 0; i < slots_.size(); ++i)
        collect(slots_[(oldest + i) % slots_.size()]);
    closeWall();
}

Answer Renderer::read()
{
    const size_t pixels = static_cast<size_t>(options_.size.width) * options_.size.height;
    const size_t visibilityBytes = pixels * kLampCount, pictureAt = (visibilityBytes + 15) / 16 * 16;
    const size_t depthAt = pictureAt + 4 * pixels, normalsAt = depthAt + 4 * pixels + pixels % 2 * 4;
    Buffer buffer = device_.createBuffer(normalsAt + 8 * pixels, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const VkImage visibility = shadows_.visibility().image;
    const auto copy = [&](VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, uint32_t layers,
                          size_t offset) {
        const VkBufferImageCopy region{.bufferOffset = offset,
                                       .imageSubresource = {aspect, 0, 0, layers},
                                       .imageExtent = {options_.size.width, options_.size.height, 1}};
        vkCmdCopyImageToBuffer(commands, image, kCopied, buffer.buffer, 1, &region);
    };
    VkCommandBuffer commands = slots_[0].commands[0];
    begin(commands);
    barrier(commands, visibility, kColour, kReadable, kCopied, kLampCount);
    barrier(commands, depth_.image, kDepth, kReadable, kCopied);
    barrier(commands, normals_.image, kColour, kReadable, kCopied);
    copy(commands, visibility, kColour, kLampCount, 0);
    copy(commands, picture_.image, kColour, 1, pictureAt);
    copy(commands, depth_.image, kDepth, 1, depthAt);
    copy(commands, normals_.image, kColour, 1, normalsAt);
    barrier(commands, visibility, kColour, kCopied, kReadable, kLampCount);
    barrier(commands, depth_.image, kDepth, kCopied, kReadable);
    barrier(commands, normals_.image, kColour, kCopied, kReadable);
    const VkMemoryBarrier2 toHost{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                  .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                  .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                  .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                  .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &toHost};
    vkCmdPipelineBarrier2(commands, &dependency);
    submit(commands, 0);
    STRANGER_CHECK(vkQueueWaitIdle(device_.queue));

    Answer answer{.data = data_, .size = options_.size};
    const auto* pBytes = static_cast<const std::byte*>(buffer.mapped);
    const auto take = [&](auto& array, size_t count, size_t offset) {
        array.resize(count);
        std::memcpy(array.data(), pBytes + offset, count * sizeof array[0]);
    };
    take(answer.visibility, visibilityBytes, 0);
    take(answer.pixels, 4 * pixels, pictureAt);
    take(answer.depth, pixels, depthAt);
    take(answer.normals, 4 * pixels, normalsAt);
    device_.destroy(buffer);
    return answer;
}
} // namespace stranger
