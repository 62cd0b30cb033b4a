#include "runtime/passes/barriers.hpp"

#include "runtime/passes/pass_graph.hpp"

namespace gnomon {

namespace {

void join(SyncState& state, const AccessTraits& use)
{
    state.nextLayout = use.layout;
    state.nextStages |= use.stages;
    state.nextAccess |= use.access;
    state.nextWrite |= use.write;
}

/// The state once the batch has run: a new write, or one more read of the last one.
void advance(SyncState& state, bool newWrite)
{
    if (newWrite) {
        state.writeStages = state.nextStages;
        state.writeAccess = state.nextWrite ? state.nextAccess : 0;
        state.readStages = state.visibleStages = 0;
        state.visibleAccess = 0;
    }
    if (!state.nextWrite) { // a mere layout transition is visible to those it was made for
        state.readStages |= state.nextStages;
        state.visibleStages |= state.nextStages;
        state.visibleAccess |= state.nextAccess;
    }
    state.layout = state.nextLayout;
    state.nextStages = 0;
    state.nextAccess = 0;
    state.nextWrite = false;
}

bool visible(const SyncState& state)
{
    return (state.nextStages & ~state.visibleStages) == 0 && (state.nextAccess & ~state.visibleAccess) == 0;
}

} // namespace

void BarrierBatch::image(PooledImage& image, std::uint32_t layer, std::uint32_t layerCount, const AccessTraits& use)
{
    for (std::uint32_t i = layer; i < layer + layerCount; ++i) {
        if (image.layers[i].nextStages == 0) layers_.push_back({&image, i});
        join(image.layers[i], use);
    }
}

void BarrierBatch::buffer(PooledBuffer& buffer, const AccessTraits& use)
{
    if (buffer.sync.nextStages == 0) buffers_.push_back(&buffer);
    join(buffer.sync, use);
}

void BarrierBatch::add(PooledImage& image, std::uint32_t layer, VkPipelineStageFlags2 source)
{
    const SyncState& state = image.layers[layer];
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = source,
        .srcAccessMask = state.writeAccess,
        .dstStageMask = state.nextStages,
        .dstAccessMask = state.nextAccess,
        .oldLayout = state.layout,
        .newLayout = state.nextLayout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image.gpu.image,
        .subresourceRange = {aspectsOf(image.gpu.format), 0, 1, layer, 1},
    };
    // Consecutive layers in the same state need one barrier.
    if (!images_.empty()) {
        VkImageMemoryBarrier2& last = images_.back();
        if (last.image == barrier.image && last.oldLayout == barrier.oldLayout && last.newLayout == barrier.newLayout &&
            last.srcStageMask == barrier.srcStageMask && last.srcAccessMask == barrier.srcAccessMask &&
            last.dstStageMask == barrier.dstStageMask && last.dstAccessMask == barrier.dstAccessMask &&
            last.subresourceRange.baseArrayLayer + last.subresourceRange.layerCount == layer) {
            ++last.subresourceRange.layerCount;
            return;
        }
    }
    images_.push_back(barrier);
}

void BarrierBatch::flush(PooledImage& image, std::uint32_t layer)
{
    SyncState& state = image.layers[layer];
    const bool newWrite = state.nextWrite || state.layout != state.nextLayout;
    if (newWrite)
        add(image, layer, state.writeStages | state.readStages);
    else if (!visible(state))
        add(image, layer, state.writeStages);
    advance(state, newWrite);
}

void BarrierBatch::flush(PooledBuffer& buffer)
{
    SyncState& state = buffer.sync;
    const VkPipelineStageFlags2 source = state.nextWrite  ? state.writeStages | state.readStages
                                         : visible(state) ? 0
                                                          : state.writeStages;
    if (source) {
        memory_.srcStageMask |= source;
        memory_.srcAccessMask |= state.writeAccess;
        memory_.dstStageMask |= state.nextStages;
        memory_.dstAccessMask |= state.nextAccess;
    }
    advance(state, state.nextWrite);
}

void BarrierBatch::toHost()
{
    memory_.srcStageMask |= VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    memory_.srcAccessMask |= VK_ACCESS_2_MEMORY_WRITE_BIT;
    // Not only for the CPU to read: a buffer that was copied to and is then given back may be a mesh's memory in the
    // next frame, written by the CPU and read as vertices without any pass of ours in between.
    memory_.dstStageMask |= VK_PIPELINE_STAGE_2_HOST_BIT | VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    memory_.dstAccessMask |= VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
}

void BarrierBatch::afterTransfers()
{
    memory_.srcStageMask |= VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    memory_.srcAccessMask |= VK_ACCESS_2_TRANSFER_WRITE_BIT;
    memory_.dstStageMask |= VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    memory_.dstAccessMask |= VK_ACCESS_2_TRANSFER_WRITE_BIT;
}

void BarrierBatch::full(VkCommandBuffer cmd)
{
    const VkMemoryBarrier2 all{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                               .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                               .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                               .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                               .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &all};
    vk_.vkCmdPipelineBarrier2(cmd, &info);
}

void BarrierBatch::record(VkCommandBuffer cmd)
{
    for (const Layer& used : layers_)
        flush(*used.image, used.layer);
    for (PooledBuffer* buffer : buffers_)
        flush(*buffer);
    const bool memory = memory_.srcStageMask != 0;
    if (!memory && images_.empty()) return clear();
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .memoryBarrierCount = memory ? 1u : 0u,
                                .pMemoryBarriers = &memory_,
                                .imageMemoryBarrierCount = static_cast<std::uint32_t>(images_.size()),
                                .pImageMemoryBarriers = images_.data()};
    vk_.vkCmdPipelineBarrier2(cmd, &info);
    clear();
}

void BarrierBatch::clear()
{
    layers_.clear();
    buffers_.clear();
    images_.clear();
    memory_ = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
}

} // namespace gnomon
