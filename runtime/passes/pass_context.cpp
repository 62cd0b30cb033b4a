#include "runtime/passes/pass_context.hpp"

#include <algorithm>

#include "runtime/passes/frame_slot.hpp"
#include "runtime/scene/bias.hpp"
#include "runtime/scene/mesh_chunks.hpp"
#include "runtime/vk/pipeline_create.hpp"

namespace gnomon {

// --- GPU passes ---

Bound PassContext::sampled(std::uint32_t binding, ImageId image, SamplerKind sampler, std::uint32_t layer) const
{
    return {.binding = binding, .kind = BindingKind::sampledImage, .image = image, .layer = layer, .sampler = sampler};
}
Bound PassContext::stencilOf(std::uint32_t binding, ImageId image) const
{
    return {.binding = binding, .kind = BindingKind::sampledImage, .image = image, .stencil = true};
}
Bound PassContext::storage(std::uint32_t binding, ImageId image, std::uint32_t layer) const
{
    return {.binding = binding, .kind = BindingKind::storageImage, .image = image, .layer = layer};
}
Bound PassContext::storage(std::uint32_t binding, BufferId buffer) const
{
    return {.binding = binding, .kind = BindingKind::storageBuffer, .buffer = buffer};
}
Bound PassContext::storage(std::uint32_t binding, VkBuffer buffer) const
{
    return {.binding = binding, .kind = BindingKind::storageBuffer, .rawBuffer = buffer};
}

Bound PassContext::structure(std::uint32_t binding, BufferId topLevel) const
{
    return {.binding = binding, .kind = BindingKind::structure, .buffer = topLevel};
}

Bound PassContext::constantsBytes(std::uint32_t binding, const void* data, std::size_t size)
{
    PassExecutor::Slot& slot = *executor_->slot_;
    const VkDeviceSize alignment = std::max<VkDeviceSize>(vk->properties.limits.minUniformBufferOffsetAlignment, 16);
    VkDeviceSize offset = (slot.chunkUsed + alignment - 1) / alignment * alignment;
    if (slot.chunk < slot.constants.size() && offset + size > kConstantsChunk) {
        ++slot.chunk;
        offset = 0;
    }
    if (slot.chunk == slot.constants.size()) {
        Result<GpuBuffer> made = executor_->memory_.createBuffer(kConstantsChunk, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
                                                                 MemoryUse::upload, "frame.constants");
        if (!made) throw PassExecutor::RecordingFailed{made.error()};
        slot.constants.push_back(*made);
        offset = 0;
    }
    GpuBuffer& chunk = slot.constants[slot.chunk];
    std::memcpy(chunk.mapped + offset, data, size);
    slot.chunkUsed = offset + size;
    return {.binding = binding,
            .rawBuffer = chunk.buffer,
            .offset = static_cast<std::uint32_t>(offset),
            .size = static_cast<std::uint32_t>(size)};
}

void PassContext::bind(PipelineId id, std::span<const Bound> bindings)
{
    const Pipeline& pipeline = executor_->pipelines_.get(id);
    bound_ = id;
    vk->vkCmdBindPipeline(cmd, pipeline.bindPoint, pipeline.pipeline);
    if (pipeline.bindings.empty()) return;

    DescriptorWrite writes[kMaxBindings];
    std::uint32_t offsets[kMaxBindings];
    std::uint32_t count = 0, offsetCount = 0;
    // Dynamic offsets are given in the order of bindings.
    for (const BindingInfo& info : pipeline.bindings) {
        const auto bound =
            std::find_if(bindings.begin(), bindings.end(), [&](const Bound& b) { return b.binding == info.binding; });
        if (bound == bindings.end()) continue;
        DescriptorWrite& write = writes[count++];
        write = {.binding = info.binding, .kind = info.kind};
        if (info.kind == BindingKind::constants) {
            write.buffer = bound->rawBuffer;
            write.range = bound->size;
            offsets[offsetCount++] = bound->offset;
        } else if (info.kind == BindingKind::storageBuffer) {
            write.buffer = bound->rawBuffer ? bound->rawBuffer : executor_->graph_.buffer(bound->buffer).gpu.buffer;
            if (!bound->rawBuffer) write.range = executor_->graph_.boundSize(bound->buffer);
        } else if (info.kind == BindingKind::structure) {
            write.structure = structure(bound->buffer);
        } else {
            const GpuImage& image = executor_->graph_.image(bound->image).gpu;
            const std::uint32_t layer = bound->layer == VK_REMAINING_ARRAY_LAYERS ? 0 : bound->layer;
            write.view = bound->stencil ? image.stencilView : info.array ? image.view : image.layerSampled[layer];
            write.layout = info.kind == BindingKind::storageImage ? VK_IMAGE_LAYOUT_GENERAL
                                                                  : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
            write.sampler = executor_->samplers_.get(bound->sampler);
        }
    }
    Result<VkDescriptorSet> set =
        executor_->slot_->descriptors.next(pipeline.setLayout, std::span<const DescriptorWrite>(writes, count));
    if (!set) throw PassExecutor::RecordingFailed{set.error()};
    const VkDescriptorSet handle = *set;
    vk->vkCmdBindDescriptorSets(cmd, pipeline.bindPoint, pipeline.layout, 0, 1, &handle, offsetCount, offsets);
}

void PassContext::pushBytes(const void* data, std::size_t size, std::size_t offset)
{
    const Pipeline& pipeline = executor_->pipelines_.get(bound_);
    vk->vkCmdPushConstants(cmd, pipeline.layout, pipeline.pushStages, static_cast<std::uint32_t>(offset),
                           static_cast<std::uint32_t>(size), data);
}

bool PassContext::clipTo(const VkRect2D& pixels) const
{
    if (pixels.extent.width != 0) vk->vkCmdSetScissor(cmd, 0, 1, &pixels);
    return pixels.extent.width != 0;
}

void PassContext::drawFullscreen()
{
    vk->vkCmdDraw(cmd, 3, 1, 0, 0);
}

void PassContext::drawCasters(const CasterDraw& draw)
{
    bind(draw.pipeline, draw.bindings);
    if (draw.push) pushBytes(draw.push, draw.pushSize);
    const VkDeviceSize zero = 0;
    vk->vkCmdBindVertexBuffers(cmd, kTransformsBinding, 1, &executor_->slot_->transforms.buffer, &zero);
    if (draw.depthFromOne) setViewport(1.0f, 0.0f);

    const MeshView* mesh = nullptr;
    CasterRaster state;
    bool first = true, hostDrawn = false;
    for (const Caster* caster : draw.casters) {
        if (!touches(caster->bounds, draw.volume)) continue;
        if (caster->hostDrawn) {
            hostDrawn = true;
            continue;
        }
        const CasterRaster wanted = casterRaster(*caster, draw.biasOpen);
        if (first || wanted.cullMode != state.cullMode) vk->vkCmdSetCullMode(cmd, wanted.cullMode);
        if (first || wanted.frontFace != state.frontFace) vk->vkCmdSetFrontFace(cmd, wanted.frontFace);
        if (first || wanted.slopeBias != state.slopeBias) vk->vkCmdSetDepthBias(cmd, 0.0f, 0.0f, wanted.slopeBias);
        state = wanted;
        first = false;
        if (caster->mesh != mesh) {
            mesh = caster->mesh;
            vk->vkCmdBindVertexBuffers(cmd, 0, 1, &mesh->vertexBuffer, &zero);
            vk->vkCmdBindIndexBuffer(cmd, mesh->indexBuffer, 0, VK_INDEX_TYPE_UINT32);
        }
        drawFaces(draw, *caster);
    }
    if (draw.depthFromOne) setViewport(0.0f, 1.0f);
    if (!hostDrawn || !draw.hostProjection) return;
    // Last, because the host may leave any state behind: bind() and the first of our casters set all of theirs but
    // viewport and scissor, which are there again for the pass's next draw.
    for (const Caster* caster : draw.casters) {
        if (!caster->hostDrawn || !touches(caster->bounds, draw.volume)) continue;
        vk->vkCmdSetDepthBias(cmd, 0.0f, 0.0f, draw.hostProjection->slopeBias);
        caster->drawCasters(cmd, draw.hostProjection, caster->userData);
        setArea();
    }
}

/// @pre the mesh is bound
void PassContext::drawFaces(const CasterDraw& draw, const Caster& caster)
{
    const std::uint32_t end = draw.firstFace + std::min(draw.faceCount, UINT32_MAX - draw.firstFace);
    forFacesIn(draw.volume, caster, {draw.firstFace, end}, [&](const FaceRange& faces) {
        if (draw.numbered) pushBytes(&faces.first, sizeof(faces.first), draw.pushSize);
        vk->vkCmdDrawIndexed(cmd, 3 * (faces.end - faces.first), 1, 3 * faces.first, 0, caster.index);
    });
}

void PassContext::setArea() const
{
    setViewport(0.0f, 1.0f);
    vk->vkCmdSetScissor(cmd, 0, 1, &area);
}

void PassContext::setViewport(float first, float last) const
{
    const VkViewport viewport{static_cast<float>(area.offset.x),
                              static_cast<float>(area.offset.y),
                              static_cast<float>(area.extent.width),
                              static_cast<float>(area.extent.height),
                              first,
                              last};
    vk->vkCmdSetViewport(cmd, 0, 1, &viewport);
}

VkImage PassContext::image(ImageId id) const
{
    return executor_->graph_.image(id).gpu.image;
}
VkImageView PassContext::imageView(ImageId id, std::uint32_t layer) const
{
    return executor_->graph_.image(id).gpu.layerSampled[layer];
}
VkExtent2D PassContext::extent(ImageId id) const
{
    return executor_->graph_.image(id).gpu.extent;
}
VkBuffer PassContext::buffer(BufferId id) const
{
    return executor_->graph_.buffer(id).gpu.buffer;
}
VkAccelerationStructureKHR PassContext::structure(BufferId id) const
{
    return executor_->graph_.buffer(id).gpu.structure;
}

bool PassContext::has(ImageId id, std::uint32_t layer) const
{
    return PassBuilder(executor_->graph_).has(id, layer, 1);
}
bool PassContext::has(BufferId id) const
{
    return PassBuilder(executor_->graph_).has(id);
}

// --- CPU passes ---

bool HostContext::has(BufferId buffer) const
{
    return PassBuilder(executor_->graph_).has(buffer);
}

std::span<std::byte> HostContext::mapped(BufferId buffer) const
{
    const PooledBuffer& pooled = executor_->graph_.buffer(buffer);
    if (isGpuOnly(pooled.place)) return {}; // also where all memory of the device happens to be mapped
    const GpuBuffer& gpu = pooled.gpu;
    return {gpu.mapped, gpu.mapped ? static_cast<std::size_t>(gpu.size) : 0};
}

void HostContext::countRays(std::uint64_t count) const
{
    executor_->counters_.rays += count;
}
void HostContext::countIndexList() const
{
    ++executor_->counters_.indexListsBuilt;
}

void HostContext::later(void (*fn)(const void*, PassBuilder&), const void* body, std::size_t size,
                        std::size_t alignment)
{
    void* copy = arena->allocate(size, alignment);
    std::memcpy(copy, body, size);
    const std::lock_guard lock(executor_->laterMutex_);
    executor_->later_.push_back({fn, copy, pass_});
}

} // namespace gnomon
