#include "runtime/passes/barriers.hpp"

#include "runtime/passes/pass_graph.hpp"

namespace gnomon {

void BarrierBatch::add(PooledImage& image, std::uint32_t layer, const SyncState& old, const AccessTraits& use,
                       VkPipelineStageFlags2 source)
{
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = source,
        .srcAccessMask = old.writeAccess,
        .dstStageMask = use.stages,
        .dstAccessMask = use.access,
        .oldLayout = old.layout,
        .newLayout = use.layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image.gpu.image,
        .subresourceRange = {aspectsOf(image.gpu.format), 0, 1, layer, 1},
    };
    // Consecutive layers in the same state need one barrier.
    if (!images_.empty()) {
        VkImageMemoryBarrier2& last = images_.back();
        if (last.image == barrier.image && last.oldLayout == barrier.oldLayout &&
            last.newLayout == barrier.newLayout && last.srcStageMask == barrier.srcStageMask &&
            last.srcAccessMask == barrier.srcAccessMask && last.dstStageMask == barrier.dstStageMask &&
            last.dstAccessMask == barrier.dstAccessMask &&
            last.subresourceRange.baseArrayLayer + last.subresourceRange.layerCount == layer) {
            ++last.subresourceRange.layerCount;
            return;
        }
    }
    images_.push_back(barrier);
}

void BarrierBatch::image(PooledImage& image, std::uint32_t layer, std::uint32_t layerCount, const AccessTraits& use)
{
    for (std::uint32_t i = layer; i < layer + layerCount; ++i) {
        SyncState& state = image.layers[i];
        const bool moves = state.layout != use.layout;
        const bool visible = (use.stages & ~state.visibleStages) == 0 && (use.access & ~state.visibleAccess) == 0;
        if (use.write || moves) {
            add(image, i, state, use, state.writeStages | state.readStages);
            if (use.write)
                state = {.layout = use.layout, .writeStages = use.stages, .writeAccess = use.access};
            else // the transition is the newest write; it is visible to this use only
                state = {.layout = use.layout,
                         .writeStages = use.stages,
                         .readStages = use.stages,
                         .visibleStages = use.stages,
                         .visibleAccess = use.access};
            continue;
        }
        if (!visible) {
            add(image, i, state, use, state.writeStages);
            state.visibleStages |= use.stages;
            state.visibleAccess |= use.access;
        }
        state.readStages |= use.stages;
    }
}

void BarrierBatch::buffer(PooledBuffer& buffer, const AccessTraits& use)
{
    SyncState& state = buffer.sync;
    if (use.write) {
        memory_.srcStageMask |= state.writeStages | state.readStages;
        memory_.srcAccessMask |= state.writeAccess;
        if (state.writeStages | state.readStages) {
            memory_.dstStageMask |= use.stages;
            memory_.dstAccessMask |= use.access;
        }
        state = {.writeStages = use.stages, .writeAccess = use.access};
        return;
    }
    const bool visible = (use.stages & ~state.visibleStages) == 0 && (use.access & ~state.visibleAccess) == 0;
    if (state.writeStages && !visible) {
        memory_.srcStageMask |= state.writeStages;
        memory_.srcAccessMask |= state.writeAccess;
        memory_.dstStageMask |= use.stages;
        memory_.dstAccessMask |= use.access;
        state.visibleStages |= use.stages;
        state.visibleAccess |= use.access;
    }
    state.readStages |= use.stages;
}

void BarrierBatch::toHost()
{
    memory_.srcStageMask |= VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    memory_.srcAccessMask |= VK_ACCESS_2_MEMORY_WRITE_BIT;
    memory_.dstStageMask |= VK_PIPELINE_STAGE_2_HOST_BIT;
    memory_.dstAccessMask |= VK_ACCESS_2_HOST_READ_BIT;
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
    const bool memory = memory_.srcStageMask != 0;
    if (!memory && images_.empty()) return;
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .memoryBarrierCount = memory ? 1u : 0u,
                                .pMemoryBarriers = &memory_,
                                .imageMemoryBarrierCount = static_cast<std::uint32_t>(images_.size()),
                                .pImageMemoryBarriers = images_.data()};
    vk_.vkCmdPipelineBarrier2(cmd, &info);
    images_.clear();
    memory_ = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
}

} // namespace gnomon
