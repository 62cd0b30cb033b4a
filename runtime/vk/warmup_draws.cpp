#include "runtime/vk/warmup_draws.hpp"

#include <algorithm>
#include <array>

#include "runtime/vk/structures.hpp"

namespace gnomon {
namespace {

constexpr VkDeviceSize kBufferSize = 64 * 1024;
constexpr std::uint32_t kTargetSide = 4;
constexpr std::uint32_t kMaxConstants = 8; // maxDescriptorSetUniformBuffersDynamic of every device

// Sampling code differs between sides that are powers of two and others.
constexpr VkExtent2D kMapExtent{4, 4};
constexpr VkExtent2D kScreenExtent{3, 5};

/// Everything before happens before everything after: draws share their stand-ins.
void fullBarrier(const DeviceTable& vk, VkCommandBuffer cmd, std::span<const VkImageMemoryBarrier2> images = {})
{
    const VkMemoryBarrier2 memory{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                  .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                  .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .memoryBarrierCount = 1,
                                .pMemoryBarriers = &memory,
                                .imageMemoryBarrierCount = static_cast<std::uint32_t>(images.size()),
                                .pImageMemoryBarriers = images.data()};
    vk.vkCmdPipelineBarrier2(cmd, &info);
}

VkImageSubresourceRange wholeOf(const GpuImage& image)
{
    return {aspectsOf(image.format), 0, 1, 0, image.layers};
}

VkImageView viewFor(const GpuImage& image, const BindingInfo& binding)
{
    if (binding.stencil) return image.stencilView;
    return binding.array ? image.view : image.layerSampled[0];
}

} // namespace

WarmupDraws::WarmupDraws(const DeviceTable& vk, DeviceMemory& memory, const SamplerSet& samplers)
    : vk_(vk), memory_(memory), samplers_(samplers), sets_(vk)
{
}

WarmupDraws::~WarmupDraws()
{
    memory_.destroy(zeros_);
    for (GpuBuffer& buffer : storage_)
        memory_.destroy(buffer);
    for (const std::unique_ptr<StandIn>& standIn : standIns_)
        memory_.destroy(standIn->image);
    memory_.destroy(structure_);
    memory_.destroy(scratch_);
    marks_.destroy(memory_);
}

Result<void> WarmupDraws::record(VkCommandBuffer cmd, std::span<const Candidate> candidates, float slopeBias)
{
    if (candidates.empty()) return {};
    if (Result<void> made = makeBuffers(); !made) return made;
    std::vector<WarmupDraw> draws;
    draws.reserve(candidates.size());
    for (const Candidate& candidate : candidates) {
        Result<WarmupDraw> draw = prepare(candidate);
        if (!draw) return draw.error();
        draws.push_back(*draw);
    }
    clearStandIns(cmd);
    buildStructure(cmd);
    names_.reserve(names_.size() + draws.size());
    for (const WarmupDraw& draw : draws) {
        marks_.mark(vk_, cmd, static_cast<std::uint32_t>(names_.size()));
        names_.push_back(draw.candidate.description->name());
        clearStorage(cmd);
        fullBarrier(vk_, cmd);
        if (draw.candidate.description->isCompute)
            recordDispatch(cmd, draw);
        else
            recordDraw(cmd, draw, slopeBias);
        fullBarrier(vk_, cmd);
    }
    return {};
}

std::string WarmupDraws::lastBegun() const
{
    const std::uint32_t begun = marks_.begun();
    return begun ? names_[begun - 1] : "";
}

Result<void> WarmupDraws::makeBuffers()
{
    if (zeros_.buffer) return {};
    if (Result<void> marks = marks_.create(memory_, "warmup.progress"); !marks) return marks;
    const VkBufferUsageFlags usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                     VK_BUFFER_USAGE_INDEX_BUFFER_BIT | (vk_.rayQuery() ? kBuildInput : 0);
    Result<GpuBuffer> made = memory_.createBuffer(kBufferSize, usage, MemoryUse::upload, "warmup.zeros");
    if (!made) return made.error();
    zeros_ = *made;
    std::memset(zeros_.mapped, 0, kBufferSize);
    return {};
}

Result<VkBuffer> WarmupDraws::storage(std::size_t index)
{
    while (storage_.size() <= index) {
        storage_.emplace_back();
        constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
        Result<GpuBuffer> made = memory_.createBuffer(kBufferSize, kUsage, MemoryUse::device, "warmup.storage");
        if (!made) {
            storage_.pop_back();
            return made.error();
        }
        storage_.back() = *made;
    }
    return storage_[index].buffer;
}

namespace {

/// A top level without instances. The geometry is the caller's to keep.
VkAccelerationStructureBuildGeometryInfoKHR emptyScene(const VkAccelerationStructureGeometryKHR& geometry)
{
    VkAccelerationStructureBuildGeometryInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR;
    info.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
    info.geometryCount = 1;
    info.pGeometries = &geometry;
    return info;
}

} // namespace

Result<VkAccelerationStructureKHR> WarmupDraws::structure()
{
    if (structure_.structure) return structure_.structure;
    const VkAccelerationStructureGeometryKHR geometry = instancesAt(zeros_.address);
    const VkAccelerationStructureBuildGeometryInfoKHR info = emptyScene(geometry);
    const std::uint32_t none = 0;
    VkAccelerationStructureBuildSizesInfoKHR sizes{};
    sizes.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR;
    vk_.vkGetAccelerationStructureBuildSizesKHR(vk_.device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info,
                                                &none, &sizes);
    Result<GpuBuffer> scratch = memory_.createBuffer(sizes.buildScratchSize + vk_.scratchAlignment, kBuildScratch,
                                                     MemoryUse::device, "warmup.scratch");
    if (!scratch) return scratch.error();
    memory_.destroy(scratch_);
    scratch_ = *scratch;
    Result<GpuBuffer> made = memory_.createStructure(sizes.accelerationStructureSize,
                                                     VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, "warmup.structure");
    if (!made) return made.error();
    structure_ = *made;
    return structure_.structure;
}

/// Anew in each recording, as the other stand-ins: an earlier one may have been dropped.
void WarmupDraws::buildStructure(VkCommandBuffer cmd) const
{
    if (!structure_.structure) return;
    const VkAccelerationStructureGeometryKHR geometry = instancesAt(zeros_.address);
    VkAccelerationStructureBuildGeometryInfoKHR info = emptyScene(geometry);
    info.dstAccelerationStructure = structure_.structure;
    info.scratchData.deviceAddress = alignedUp(scratch_.address, vk_.scratchAlignment);
    const VkAccelerationStructureBuildRangeInfoKHR none{};
    const VkAccelerationStructureBuildRangeInfoKHR* const ranges = &none;
    fullBarrier(vk_, cmd);
    vk_.vkCmdBuildAccelerationStructuresKHR(cmd, 1, &info, &ranges);
    fullBarrier(vk_, cmd);
}

Result<const GpuImage*> WarmupDraws::standIn(VkFormat format, VkImageUsageFlags usage, bool powerOfTwo, bool target)
{
    usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT; // cleared: a shader that loops over what it reads must end
    for (const std::unique_ptr<StandIn>& at : standIns_)
        if (at->image.format == format && at->image.usage == usage && at->powerOfTwo == powerOfTwo &&
            at->target == target)
            return &at->image;
    standIns_.reserve(standIns_.size() + 1);
    auto made = std::make_unique<StandIn>();
    made->powerOfTwo = powerOfTwo;
    made->target = target;
    Result<GpuImage> image = memory_.createImage({.format = format,
                                                  .extent = powerOfTwo ? kMapExtent : kScreenExtent,
                                                  .layers = 1,
                                                  .usage = usage,
                                                  .name = target ? "warmup.target" : "warmup.image"});
    if (!image) return image.error();
    made->image = *image;
    standIns_.push_back(std::move(made));
    return &standIns_.back()->image;
}

Result<WarmupDraws::WarmupDraw> WarmupDraws::prepare(const Candidate& candidate)
{
    WarmupDraw draw;
    draw.candidate = candidate;
    Result<VkDescriptorSet> set = makeSet(candidate, draw);
    if (!set) return set.error();
    draw.set = *set;
    if (candidate.description->isCompute) return draw;
    const GraphicsPipelineInfo& info = candidate.description->graphics;
    if (info.colorFormat != VK_FORMAT_UNDEFINED) {
        Result<const GpuImage*> color = standIn(info.colorFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, true, true);
        if (!color) return color.error();
        draw.color = *color;
    }
    if (info.depthFormat != VK_FORMAT_UNDEFINED) {
        Result<const GpuImage*> depth =
            standIn(info.depthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, true, true);
        if (!depth) return depth.error();
        draw.depth = *depth;
    }
    return draw;
}

Result<VkDescriptorSet> WarmupDraws::makeSet(const Candidate& candidate, WarmupDraw& draw)
{
    std::vector<DescriptorWrite> writes;
    std::size_t storageCount = 0;
    for (const BindingInfo& binding : candidate.pipeline->bindings) {
        DescriptorWrite write{.binding = binding.binding, .kind = binding.kind};
        if (binding.kind == BindingKind::constants) {
            write.buffer = zeros_.buffer;
            write.range = kConstantsRange;
            ++draw.constants;
        } else if (binding.kind == BindingKind::storageBuffer) {
            Result<VkBuffer> buffer = storage(storageCount++);
            if (!buffer) return buffer.error();
            write.buffer = *buffer;
        } else if (binding.kind == BindingKind::structure) {
            Result<VkAccelerationStructureKHR> empty = structure();
            if (!empty) return empty.error();
            write.structure = *empty;
        } else {
            const bool sampled = binding.kind == BindingKind::sampledImage;
            Result<const GpuImage*> image =
                standIn(binding.format, sampled ? VK_IMAGE_USAGE_SAMPLED_BIT : VK_IMAGE_USAGE_STORAGE_BIT,
                        binding.powerOfTwo, false);
            if (!image) return image.error();
            write.view = viewFor(**image, binding);
            write.layout = VK_IMAGE_LAYOUT_GENERAL;
            write.sampler = sampled ? samplers_.get(binding.sampler) : VK_NULL_HANDLE;
        }
        writes.push_back(write);
    }
    return sets_.next(candidate.pipeline->setLayout, writes);
}

/// Whatever the stand-ins went through before, a recording starts them afresh: it may be dropped, and recorded ones may
/// still be in flight. They stay in GENERAL, which every use allows.
void WarmupDraws::clearStandIns(VkCommandBuffer cmd) const
{
    std::vector<VkImageMemoryBarrier2> barriers;
    barriers.reserve(standIns_.size());
    for (const std::unique_ptr<StandIn>& standIn : standIns_)
        barriers.push_back({.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                            .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                            .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                            .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                            .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
                            .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                            .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                            .image = standIn->image.image,
                            .subresourceRange = wholeOf(standIn->image)});
    fullBarrier(vk_, cmd, barriers);
    for (const std::unique_ptr<StandIn>& standIn : standIns_) {
        const GpuImage& image = standIn->image;
        const VkImageSubresourceRange range = wholeOf(image);
        if (range.aspectMask & VK_IMAGE_ASPECT_COLOR_BIT) {
            const VkClearColorValue zero{};
            vk_.vkCmdClearColorImage(cmd, image.image, VK_IMAGE_LAYOUT_GENERAL, &zero, 1, &range);
        } else {
            const VkClearDepthStencilValue zero{};
            vk_.vkCmdClearDepthStencilImage(cmd, image.image, VK_IMAGE_LAYOUT_GENERAL, &zero, 1, &range);
        }
    }
}

void WarmupDraws::clearStorage(VkCommandBuffer cmd) const
{
    for (const GpuBuffer& buffer : storage_)
        vk_.vkCmdFillBuffer(cmd, buffer.buffer, 0, VK_WHOLE_SIZE, 0);
}

void WarmupDraws::bind(VkCommandBuffer cmd, const WarmupDraw& draw) const
{
    const Pipeline& pipeline = *draw.candidate.pipeline;
    constexpr std::array<std::uint32_t, kMaxConstants> kOffsets{};
    constexpr std::array<std::byte, 128> kPush{};
    vk_.vkCmdBindPipeline(cmd, pipeline.bindPoint, pipeline.pipeline);
    vk_.vkCmdBindDescriptorSets(cmd, pipeline.bindPoint, pipeline.layout, 0, 1, &draw.set,
                                std::min(draw.constants, kMaxConstants), kOffsets.data());
    if (pipeline.pushBytes)
        vk_.vkCmdPushConstants(cmd, pipeline.layout, pipeline.pushStages, 0, pipeline.pushBytes, kPush.data());
}

void WarmupDraws::recordDispatch(VkCommandBuffer cmd, const WarmupDraw& draw) const
{
    bind(cmd, draw);
    vk_.vkCmdDispatch(cmd, 1, 1, 1);
}

void WarmupDraws::recordDraw(VkCommandBuffer cmd, const WarmupDraw& draw, float slopeBias) const
{
    VkRenderingAttachmentInfo color{};
    color.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    color.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingAttachmentInfo depth = color;
    if (draw.color) color.imageView = draw.color->layerViews[0];
    if (draw.depth) depth.imageView = draw.depth->layerViews[0];
    const VkImageAspectFlags aspects = draw.depth ? aspectsOf(draw.depth->format) : 0;
    const VkRect2D area{{0, 0}, {kTargetSide, kTargetSide}};
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = area,
                                    .layerCount = 1,
                                    .colorAttachmentCount = draw.color ? 1u : 0u,
                                    .pColorAttachments = &color,
                                    .pDepthAttachment = aspects & VK_IMAGE_ASPECT_DEPTH_BIT ? &depth : nullptr,
                                    .pStencilAttachment = aspects & VK_IMAGE_ASPECT_STENCIL_BIT ? &depth : nullptr};
    const VkViewport viewport{0.0f, 0.0f, float(kTargetSide), float(kTargetSide), 0.0f, 1.0f};
    const VkDeviceSize offset = 0;
    vk_.vkCmdBeginRendering(cmd, &rendering);
    bind(cmd, draw);
    vk_.vkCmdSetViewport(cmd, 0, 1, &viewport);
    vk_.vkCmdSetScissor(cmd, 0, 1, &area);
    if (draw.candidate.description->graphics.vertexStride)
        vk_.vkCmdBindVertexBuffers(cmd, 0, 1, &zeros_.buffer, &offset);
    if (draw.candidate.description->graphics.transforms)
        vk_.vkCmdBindVertexBuffers(cmd, kTransformsBinding, 1, &zeros_.buffer, &offset);
    if (draw.candidate.pipeline->casters) {
        vk_.vkCmdBindIndexBuffer(cmd, zeros_.buffer, 0, VK_INDEX_TYPE_UINT32);
        vk_.vkCmdSetCullMode(cmd, VK_CULL_MODE_NONE);
        vk_.vkCmdSetFrontFace(cmd, VK_FRONT_FACE_COUNTER_CLOCKWISE);
        for (const float bias : {0.0f, slopeBias}) { // triangle set-up is compiled for the values
            vk_.vkCmdSetDepthBias(cmd, 0.0f, 0.0f, bias);
            vk_.vkCmdDrawIndexed(cmd, 3, 1, 0, 0, 0);
        }
    } else {
        vk_.vkCmdDraw(cmd, 3, 1, 0, 0);
    }
    vk_.vkCmdEndRendering(cmd);
}

} // namespace gnomon
