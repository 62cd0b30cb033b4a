#include "algorithms/hybrid/undecided_on_device.hpp"

#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid/undecided.h"
#include "shaders/hybrid_ray_query_frag.h"
#include "shaders/hybrid_undecided_comp.h"

namespace gnomon {

namespace {

constexpr std::uint32_t tilesIn(std::uint32_t pixels)
{
    return (pixels + gpu::LISTED_SIDE - 1) / gpu::LISTED_SIDE;
}

constexpr std::uint32_t groupsIn(std::uint32_t pixels)
{
    return (tilesIn(pixels) + gpu::LISTED_GROUP - 1) / gpu::LISTED_GROUP;
}

constexpr VkDeviceSize listSize(VkExtent2D extent)
{
    constexpr VkDeviceSize tile = 2 * sizeof(std::uint32_t);
    return sizeof(VkDrawIndirectCommand) + tile * tilesIn(extent.width) * tilesIn(extent.height);
}

gpu::uvec4 unsignedOf(const VkOffset2D& offset, std::uint32_t z, std::uint32_t w)
{
    return {static_cast<std::uint32_t>(offset.x), static_cast<std::uint32_t>(offset.y), z, w};
}

gpu::UndecidedConstants constantsOf(const ShadowTask& task, const VkRect2D& pixels, const Doubt& doubt)
{
    const auto [from, extent] = doubt.where.pixels;
    const gpu::uvec4 first = unsignedOf(from, 0, 0);
    return {.view = task.view->constants,
            .pixels = unsignedOf(pixels.offset, pixels.extent.width, pixels.extent.height),
            .doubted = unsignedOf(from, first.x + extent.width, first.y + extent.height),
            .boxLowerWs = gpu::vec4(doubt.where.receivers.lower, 0.0f),
            .boxUpperWs = gpu::vec4(doubt.where.receivers.upper, 0.0f),
            .doubt = {doubt.byte, 0, 0, 0}};
}

} // namespace

UndecidedOnDevice::UndecidedOnDevice(const AlgorithmServices& services, const UndecidedNames& names)
    : names_(names),
      trace_(services, names.trace, k_hybrid_ray_query_frag, VK_FORMAT_R8_UNORM, DeviceTrace::Asks::listed)
{
    find_ = services.pipelines->compute(
        names.list, {k_hybrid_undecided_comp},
        {constantsAt(0), sampledAt(2, VK_FORMAT_D32_SFLOAT), sampledAt(3, VK_FORMAT_R8_UNORM), bufferAt(4)});
}

void UndecidedOnDevice::declare(PassBuilder& passes, const ShadowTask& task, bool reasons, const Doubt& doubt) const
{
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    if (pixels.extent.width == 0 || pixels.extent.height == 0) return; // all of it is lit
    const BufferId list = passes.transient(BufferInfo{.name = names_.list, .size = listSize(pixels.extent)});
    passes.transfer(names_.clear).writes(list).record([=](PassContext& gpu) {
        const VkDrawIndirectCommand none{.vertexCount = 0, .instanceCount = 1, .firstVertex = 0, .firstInstance = 0};
        gpu.vk->vkCmdUpdateBuffer(gpu.cmd, gpu.buffer(list), 0, sizeof none, &none);
    });
    const auto* const constants = passes.arena().make(constantsOf(task, pixels, doubt));
    passes.compute(names_.list)
        .samples(task.depth)
        .samples(task.visibility, {.layer = task.layer})
        .updates(list)
        .record([=, find = find_, depth = task.depth, status = task.visibility, layer = task.layer](PassContext& gpu) {
            gpu.bind(find, {gpu.constants(0, *constants), gpu.sampled(2, depth),
                            gpu.sampled(3, status, SamplerKind::nearest, layer), gpu.storage(4, list)});
            gpu.vk->vkCmdDispatch(gpu.cmd, groupsIn(pixels.extent.width), groupsIn(pixels.extent.height), 1);
        });
    const gpu::RayQueryConstants rays =
        reasons ? rayConstants(task, gpu::REASON_RT_LIT, gpu::REASON_RT_SHADOW) : rayConstants(task);
    trace_.declare(passes, task, rays, task.visibility, {.layer = task.layer, .blend = true}, list);
}

VkDeviceSize UndecidedOnDevice::memory(VkExtent2D extent)
{
    return pooledSize(listSize(extent));
}

} // namespace gnomon
