#include <algorithm>

#include "runtime/store/buffer_mesh.hpp"
#include "shaders/runtime/mesh_read.h"
#include "shaders/runtime_mesh_indices_comp.h"
#include "shaders/runtime_mesh_positions_comp.h"
#include "shaders/runtime_placements_comp.h"

namespace gnomon {
namespace {

constexpr BindingInfo kBindings[] = {bufferAt(0), bufferAt(1), bufferAt(2), bufferAt(3)}; // of positions
constexpr std::size_t kUnwatched = 3;

VkDescriptorBufferInfo whole(VkBuffer buffer)
{
    return {buffer, 0, VK_WHOLE_SIZE};
}

std::uint32_t formatWord(VkFormat format)
{
    if (format == VK_FORMAT_R16G16B16A16_SFLOAT) return gpu::MESH_HALVES;
    return format == VK_FORMAT_R16G16B16A16_SNORM ? gpu::MESH_SNORMS : gpu::MESH_FLOATS;
}

} // namespace

MeshConverter::MeshConverter(const DeviceTable& vk, PipelineStore& pipelines, std::uint32_t owner)
    : vk_(vk), pipelines_(pipelines), owner_(owner)
{
    pipelines_.setOwner(owner);
    positions_ = pipelines_.compute({.name = "mesh.positions",
                                     .compute = {.code = k_runtime_mesh_positions_comp},
                                     .bindings = kBindings,
                                     .pushBytes = sizeof(gpu::MeshPositionsRead)});
    indices_ = pipelines_.compute({.name = "mesh.indices",
                                   .compute = {.code = k_runtime_mesh_indices_comp},
                                   .bindings = std::span(kBindings).first(kUnwatched),
                                   .pushBytes = sizeof(gpu::MeshIndicesRead)});
    transforms_ = pipelines_.compute({.name = "instances.transforms",
                                      .compute = {.code = k_runtime_placements_comp},
                                      .bindings = std::span(kBindings).first(kUnwatched),
                                      .pushBytes = sizeof(gpu::PlacementsRead)});
}

Result<void> MeshConverter::prepare()
{
    const std::lock_guard lock(mutex_); // who comes second waits for the first
    while (pipelines_.createNext(owner_)) {
    }
    const std::string failure = pipelines_.failure(owner_);
    if (failure.empty()) return {};
    return Error{GN_ERROR_FEATURE_MISSING, "MeshPipelines",
                 "meshes and transforms in buffers cannot be read: " + failure};
}

VkDescriptorBufferInfo MeshConverter::aligned(const VkDescriptorBufferInfo& from) const
{
    const VkDeviceSize unit = std::max<VkDeviceSize>(vk_.properties.limits.minStorageBufferOffsetAlignment, 4);
    const VkDeviceSize before = from.offset % unit;
    return {from.buffer, from.offset - before, from.range + before};
}

Result<void> MeshConverter::positions(VkCommandBuffer cmd, DescriptorRing& descriptors, const BufferMesh& mesh,
                                      const MeshConnectivity* connectivity, const VkDescriptorBufferInfo& from) const
{
    const BufferMeshLayout& layout = mesh.layout;
    const VkDescriptorBufferInfo bound = aligned(from);
    const gpu::MeshPositionsRead push{.scale = {layout.scale[0], layout.scale[1], layout.scale[2], 0.0f},
                                      .bias = {layout.bias[0], layout.bias[1], layout.bias[2], 0.0f},
                                      .count = layout.positionCount,
                                      .firstWord = static_cast<std::uint32_t>((from.offset - bound.offset) / 4),
                                      .strideWords = layout.stride / 4,
                                      .format = formatWord(layout.format),
                                      .watches = connectivity ? 1u : 0u};
    // Something must be bound.
    const VkBuffer watched = connectivity ? connectivity->watched.get().buffer : mesh.findings.get().buffer;
    return dispatch(cmd, descriptors,
                    {.pipeline = positions_,
                     .from = bound,
                     .to = whole(mesh.vertices.get().buffer),
                     .findings = mesh.findings.get().buffer,
                     .watched = watched,
                     .count = layout.positionCount,
                     .push = &push,
                     .pushBytes = sizeof push});
}

Result<void> MeshConverter::indices(VkCommandBuffer cmd, DescriptorRing& descriptors, const BufferMesh& mesh,
                                    const VkDescriptorBufferInfo& from) const
{
    const BufferMeshLayout& layout = mesh.layout;
    // Without indices nothing is read of what is bound.
    const VkDescriptorBufferInfo given =
        layout.indexBytes ? from : VkDescriptorBufferInfo{mesh.findings.get().buffer, 0, sizeof(MeshFindings)};
    const VkDescriptorBufferInfo bound = aligned(given);
    const gpu::MeshIndicesRead push{.triangleCount = layout.indexCount / 3,
                                    .firstByte = static_cast<std::uint32_t>(given.offset - bound.offset),
                                    .indexBytes = layout.indexBytes,
                                    .vertexOffset = static_cast<std::uint32_t>(layout.vertexOffset),
                                    .vertexCount = layout.positionCount,
                                    .turned = layout.turned ? 1u : 0u};
    return dispatch(cmd, descriptors,
                    {.pipeline = indices_,
                     .from = bound,
                     .to = whole(mesh.indices.get().buffer),
                     .findings = mesh.findings.get().buffer,
                     .watched = VK_NULL_HANDLE,
                     .count = push.triangleCount,
                     .push = &push,
                     .pushBytes = sizeof push});
}

Result<void> MeshConverter::transforms(VkCommandBuffer cmd, DescriptorRing& descriptors, const PlacementRun& run,
                                       VkBuffer table) const
{
    // Sixteen of them are 768 bytes: a multiple of every alignment that Vulkan allows.
    constexpr std::uint32_t kRowBytes = 48, kAligned = 16;
    const std::uint32_t before = run.index % kAligned;
    const VkDescriptorBufferInfo bound = aligned(run.array.range);
    const gpu::PlacementsRead push{.shift = {run.shift[0], run.shift[1], run.shift[2], 0.0f},
                                   .count = run.count,
                                   .firstElement = run.element,
                                   .firstIndex = before,
                                   .firstWord = static_cast<std::uint32_t>((run.array.range.offset - bound.offset) / 4),
                                   .strideWords = run.array.stride / 4,
                                   .mirrored = run.array.mirrored ? 1u : 0u};
    return dispatch(
        cmd, descriptors,
        {.pipeline = transforms_,
         .from = bound,
         .to = {table, VkDeviceSize{kRowBytes} * (run.index - before), VkDeviceSize{kRowBytes} * (before + run.count)},
         .findings = run.findings->buffer.get().buffer,
         .watched = VK_NULL_HANDLE,
         .count = run.count,
         .push = &push,
         .pushBytes = sizeof push});
}

Result<void> MeshConverter::dispatch(VkCommandBuffer cmd, DescriptorRing& descriptors, const Job& job) const
{
    const Pipeline& pipeline = pipelines_.get(job.pipeline);
    const auto storage = [](std::uint32_t binding, VkBuffer buffer, VkDeviceSize offset, VkDeviceSize range) {
        return DescriptorWrite{
            .binding = binding, .kind = BindingKind::storageBuffer, .buffer = buffer, .range = range, .offset = offset};
    };
    const DescriptorWrite writes[] = {storage(0, job.from.buffer, job.from.offset, job.from.range),
                                      storage(1, job.to.buffer, job.to.offset, job.to.range),
                                      storage(2, job.findings, 0, VK_WHOLE_SIZE),
                                      storage(3, job.watched, 0, VK_WHOLE_SIZE)};
    const std::size_t bound = job.watched ? std::size(writes) : kUnwatched;
    const Result<VkDescriptorSet> set = descriptors.next(pipeline.setLayout, std::span(writes).first(bound));
    if (!set) return set.error();
    const VkDescriptorSet handle = *set;
    vk_.vkCmdBindPipeline(cmd, pipeline.bindPoint, pipeline.pipeline);
    vk_.vkCmdBindDescriptorSets(cmd, pipeline.bindPoint, pipeline.layout, 0, 1, &handle, 0, nullptr);
    vk_.vkCmdPushConstants(cmd, pipeline.layout, pipeline.pushStages, 0, job.pushBytes, job.push);
    // Every device takes 65535 groups along an axis.
    constexpr std::uint32_t kMostGroups = 65535;
    const std::uint32_t groups = (job.count + gpu::MESH_GROUP - 1) / gpu::MESH_GROUP;
    const std::uint32_t across = std::min(groups, kMostGroups);
    vk_.vkCmdDispatch(cmd, across, (groups + across - 1) / across, 1);
    return {};
}

} // namespace gnomon
