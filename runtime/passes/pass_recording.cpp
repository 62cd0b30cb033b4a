// Recording of rounds: batches, barriers, rendering scopes, timestamps; and what is read back of them.
#include <algorithm>
#include <utility>

#include "runtime/passes/frame_slot.hpp"

namespace gnomon {

namespace {

VkRect2D resolveArea(const Rect& rect, VkExtent2D extent)
{
    if (rect.width == 0) return {{0, 0}, extent};
    return {{rect.x, rect.y}, {rect.width, rect.height}};
}

bool runsOnGpu(const Pass& pass)
{
    return pass.kind != PassKind::prepare && pass.kind != PassKind::host;
}

} // namespace

/// A mark is a command between passes. Where full barriers stand there anyway, or a CPU executes it, it costs nothing;
/// elsewhere a round has one, for a GPU may have to switch engines for it.
bool PassExecutor::marksPasses() const
{
    return slot_->timed || vk_.software;
}

/// Of the pass whose entry comes next.
void PassExecutor::markBegun(VkCommandBuffer cmd)
{
    slot_->marks.mark(vk_, cmd, static_cast<std::uint32_t>(slot_->entries.size()));
}

/// So many for the slot, where the queue has any: in new pools, since the frame's earlier rounds may be at work with
/// the others.
Result<void> PassExecutor::makeQueries(Slot& slot, std::uint32_t count)
{
    while (clock_.usable() && slot.queries.size() * kQueriesPerPool < count) {
        const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                         .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                         .queryCount = kQueriesPerPool};
        slot.queries.reserve(slot.queries.size() + 1); // it may throw before there is a pool to lose
        VkQueryPool pool = VK_NULL_HANDLE;
        if (VkResult r = vk_.vkCreateQueryPool(vk_.device, &info, vk_.hostAllocator, &pool); r != VK_SUCCESS)
            return vulkanError(r, "vkCreateQueryPool");
        ++vk_.objectsMade;
        slot.queries.emplace_back(vk_, pool);
    }
    return {};
}

void PassExecutor::stamp(VkCommandBuffer cmd)
{
    if (slot_->queries.empty() || !clock_.usable()) return;
    const std::uint32_t query = slot_->queriesUsed++;
    vk_.vkCmdWriteTimestamp2(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot_->queries[query / kQueriesPerPool].get(),
                             query % kQueriesPerPool);
}

/// Those that the round may write: its own two, and in timed frames two for each of its passes.
Result<void> PassExecutor::resetQueries(VkCommandBuffer cmd, std::uint32_t round)
{
    if (slot_->queries.empty() || !clock_.usable()) return {};
    std::uint32_t wanted = 2;
    for (const std::uint32_t index : order_)
        if (slot_->timed && graph_.passes()[index].round == round && runsOnGpu(graph_.passes()[index])) wanted += 2;
    const std::uint32_t end = slot_->queriesUsed + wanted;
    if (Result<void> made = makeQueries(*slot_, end); !made) return made;
    for (std::uint32_t first = slot_->queriesUsed; first < end;) {
        const std::uint32_t at = first % kQueriesPerPool, count = std::min(end - first, kQueriesPerPool - at);
        vk_.vkCmdResetQueryPool(cmd, slot_->queries[first / kQueriesPerPool].get(), at, count);
        first += count;
    }
    return {};
}

Result<void> PassExecutor::recordRound(VkCommandBuffer cmd, std::uint32_t round, bool last)
{
    if (Result<void> reset = resetQueries(cmd, round); !reset) return reset;
    if (round == 0 && frame_.uploads && frame_.uploads->uploadsPending())
        frame_.uploads->recordUploads(cmd, frame_.frame);
    if (round == 0 && frame_.uploads && frame_.uploads->conversionsPending())
        if (auto recorded =
                frame_.uploads->recordConversions(cmd, frame_.frame, slot_->descriptors, slot_->transforms.buffer);
            !recorded)
            return recorded;
    if (round == 0 && frame_.warmupOwner != UINT32_MAX)
        if (Result<void> tried = pipelines_.recordWarmupDraws(cmd, frame_.warmupOwner); !tried)
            warmupError_ = tried.error();

    const std::uint32_t start = slot_->queriesUsed;
    stamp(cmd);
    try {
        recordBatches(cmd, round);
    } catch (const RecordingFailed& failed) {
        return failed.error;
    }
    handBackImports(); // the host has them whenever a call returns
    if (last) {
        handBack();
        showReadbacks(round);
    } else {
        barriers_.toHost();
    }
    barriers_.record(cmd);
    stamp(cmd);
    if (slot_->queriesUsed >= start + 2) slot_->rounds.push_back({start, slot_->queriesUsed - 1});
    return {};
}

void PassExecutor::recordBatches(VkCommandBuffer cmd, std::uint32_t round)
{
    bool begun = false;
    for (std::size_t i = 0; i < order_.size();) {
        const Pass& head = graph_.passes()[order_[i]];
        if (head.round != round || !runsOnGpu(head)) {
            ++i;
            continue;
        }
        std::size_t end = i;
        for (; end < order_.size(); ++end) {
            const Pass& pass = graph_.passes()[order_[end]];
            if (pass.round != round || !runsOnGpu(pass) || pass.batch != head.batch) break;
            if (!pass.fn) continue;
            for (const Access& access : graph_.accesses(pass)) {
                const AccessTraits use = accessTraits(access, pass.kind);
                if (access.isImage)
                    barriers_.image(graph_.imageAt(access.resource), access.part.layer, access.part.layerCount, use);
                else
                    barriers_.buffer(graph_.bufferAt(access.resource), use);
            }
        }
        if (!begun) barriers_.afterTransfers();
        barriers_.record(cmd);
        for (; i < end; ++i) {
            if (!graph_.passes()[order_[i]].fn) continue;
            if (!std::exchange(begun, true) || marksPasses()) markBegun(cmd);
            recordPass(cmd, graph_.passes()[order_[i]]);
        }
    }
}

void PassExecutor::recordPass(VkCommandBuffer cmd, Pass& pass)
{
    ++counters_.passesRun;
    Slot::Entry entry{.timing = {.name = pass.name, .owner = pass.owner, .round = pass.round}};
    if (slot_->timed) {
        barriers_.full(cmd);
        entry.startQuery = slot_->queriesUsed;
        stamp(cmd);
        barriers_.full(cmd);
    }
    if (vk_.vkCmdBeginDebugUtilsLabelEXT) {
        const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = pass.name};
        vk_.vkCmdBeginDebugUtilsLabelEXT(cmd, &label);
    }
    PassContext context;
    context.cmd = cmd;
    context.vk = &vk_;
    context.executor_ = this;
    if (pass.kind == PassKind::raster) {
        context.area = beginRendering(cmd, pass);
        context.setArea();
    }
    pass.fn(pass.body, &context, nullptr);
    if (pass.kind == PassKind::raster) vk_.vkCmdEndRendering(cmd);
    if (vk_.vkCmdEndDebugUtilsLabelEXT) vk_.vkCmdEndDebugUtilsLabelEXT(cmd);
    if (slot_->timed) {
        barriers_.full(cmd);
        entry.endQuery = slot_->queriesUsed;
        stamp(cmd);
    }
    slot_->entries.push_back(entry);
}

VkRect2D PassExecutor::beginRendering(VkCommandBuffer cmd, const Pass& pass)
{
    VkRenderingAttachmentInfo colors[kMaxColorAttachments];
    VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                    .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                    .storeOp = VK_ATTACHMENT_STORE_OP_NONE};
    VkRenderingAttachmentInfo stencil = depth;
    std::uint32_t colorCount = 0, layerCount = 1;
    Rect rect = pass.area;
    VkExtent2D extent{UINT32_MAX, UINT32_MAX};
    VkImageAspectFlags depthAspects = 0;
    for (const Access& access : graph_.accesses(pass)) {
        const AccessTraits traits = accessTraits(access, pass.kind);
        const bool color = access.kind == AccessKind::color || access.kind == AccessKind::colorBlend;
        const bool stencilAccess = access.kind == AccessKind::stencilTest || access.kind == AccessKind::stencilWrite;
        const bool depthAccess = access.kind == AccessKind::depthTest || access.kind == AccessKind::depthWrite;
        if (!color && !stencilAccess && !depthAccess) continue;
        const GpuImage& image = graph_.imageAt(access.resource).gpu;
        extent = {std::min(extent.width, image.extent.width), std::min(extent.height, image.extent.height)};
        if (rect.width == 0) rect = access.part.rect;
        VkImageView view = image.layerViews[access.part.layer];
        if (access.part.layerCount > 1) {
            view = image.view;
            layerCount = access.part.layerCount;
        }
        VkRenderingAttachmentInfo& info = color ? colors[colorCount++] : depthAccess ? depth : stencil;
        const VkAttachmentLoadOp load = access.part.clear                  ? VK_ATTACHMENT_LOAD_OP_CLEAR
                                        : access.kind == AccessKind::color ? VK_ATTACHMENT_LOAD_OP_DONT_CARE
                                                                           : VK_ATTACHMENT_LOAD_OP_LOAD;
        info = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                .imageView = view,
                .imageLayout = traits.layout,
                .loadOp = load,
                .storeOp = traits.write ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_NONE, // a store is one
                .clearValue = access.part.value};
        if (!color) {
            depthAspects |= aspectsOf(image.format);
            VkRenderingAttachmentInfo& other = depthAccess ? stencil : depth;
            if (!other.imageView) {
                other.imageView = view; // a combined format is attached with both aspects
                other.imageLayout = traits.layout;
            }
        }
    }
    const VkRect2D area = resolveArea(rect, extent);
    const bool hasDepth = (depthAspects & VK_IMAGE_ASPECT_DEPTH_BIT) != 0;
    const bool hasStencil = (depthAspects & VK_IMAGE_ASPECT_STENCIL_BIT) != 0;
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = area,
                               .layerCount = layerCount,
                               .colorAttachmentCount = colorCount,
                               .pColorAttachments = colors,
                               .pDepthAttachment = hasDepth ? &depth : nullptr,
                               .pStencilAttachment = hasStencil ? &stencil : nullptr};
    vk_.vkCmdBeginRendering(cmd, &info);
    return area;
}

/// What the host's shaders read becomes readable: visibility, and the maps that it may ask for.
void PassExecutor::handBack()
{
    const AccessTraits forHost{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                               VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                               VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, false};
    for (const std::vector<PooledImage*>* images : {&visibilities_, &lightMaps_})
        for (PooledImage* image : *images)
            barriers_.image(*image, 0, static_cast<std::uint32_t>(image->layers.size()), forHost);
}

/// The host's images are left as they came.
void PassExecutor::handBackImports()
{
    const AccessTraits asBefore{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                VK_ACCESS_2_MEMORY_READ_BIT, false};
    for (PooledImage* image : imports_)
        if (image->layers[0].layout != asBefore.layout) barriers_.image(*image, 0, 1, asBefore);
}

/// What the round wrote in memory that the CPU will read without another round in between: the depth grid.
void PassExecutor::showReadbacks(std::uint32_t round)
{
    const AccessTraits read = accessTraits(AccessKind::hostRead, PassKind::host);
    for (const Pass& pass : graph_.passes()) {
        if (pass.round != round || !pass.fn || !runsOnGpu(pass)) continue;
        for (const Access& access : graph_.accesses(pass)) {
            if (access.isImage || !accessTraits(access, pass.kind).write) continue;
            PooledBuffer& buffer = graph_.bufferAt(access.resource);
            if (buffer.place == BufferPlace::readback) barriers_.buffer(buffer, read);
        }
    }
}

/// Whether the stamps of a completed frame can be believed; where it has none there is nothing to doubt.
bool PassExecutor::believes(const Slot& slot)
{
    if (slot.queriesUsed == 0) return true;
    for (const Slot::Entry& entry : slot.entries)
        if (entry.endQuery < slot.queriesUsed)
            clock_.note(slot.results[entry.startQuery], slot.results[entry.endQuery], true);
    for (const Slot::Span& span : slot.rounds)
        clock_.note(slot.results[span.startQuery], slot.results[span.endQuery], false);
    return clock_.endFrame();
}

/// Timings of a completed frame; the results are there, nothing is waited for. Without queries the GPU's are 0.
void PassExecutor::collect(Slot& slot)
{
    slot.timingsPending = false;
    slot.results.resize(slot.queriesUsed);
    for (std::uint32_t first = 0; first < slot.queriesUsed; first += kQueriesPerPool) {
        const std::uint32_t count = std::min(slot.queriesUsed - first, kQueriesPerPool);
        const VkResult r = vk_.vkGetQueryPoolResults(vk_.device, slot.queries[first / kQueriesPerPool].get(), 0, count,
                                                     count * sizeof(std::uint64_t), slot.results.data() + first,
                                                     sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT);
        if (r != VK_SUCCESS) return; // not ready or lost: this frame's timings are missed
    }
    if (!believes(slot)) return;
    auto ms = [&](std::uint32_t from, std::uint32_t to) {
        const std::uint64_t ticks = clock_.between(slot.results[from], slot.results[to]);
        return static_cast<float>(static_cast<double>(ticks) * vk_.properties.limits.timestampPeriod * 1e-6);
    };
    FrameTimings& out = slot.timed ? publishedTimed_ : published_;
    if (slot.frame < out.frame) return;
    out.frame = slot.frame;
    out.timed = slot.timed;
    out.totalGpuMs = 0.0f;
    out.passes.clear();
    for (const Slot::Entry& entry : slot.entries) {
        PassTiming timing = entry.timing;
        if (entry.endQuery < slot.queriesUsed) timing.gpuMs = ms(entry.startQuery, entry.endQuery);
        if (slot.timed) out.totalGpuMs += timing.gpuMs;
        out.passes.push_back(timing);
    }
    if (!slot.timed)
        for (const Slot::Span& span : slot.rounds)
            out.totalGpuMs += ms(span.startQuery, span.endQuery);
}

} // namespace gnomon
