#include "algorithms/revectorized/distance_transform.hpp"

#include "shaders/revectorized/distance.h"
#include "shaders/revectorized_distance_columns_comp.h"
#include "shaders/revectorized_distance_rows_comp.h"

namespace gnomon {

namespace {

VkDeviceSize sitesOf(VkExtent2D extent)
{
    return sizeof(std::uint32_t) * VkDeviceSize{extent.width} * extent.height;
}

std::uint32_t groupsOf(std::uint32_t lines)
{
    return (lines + gpu::DISTANCE_GROUP - 1) / gpu::DISTANCE_GROUP;
}

} // namespace

DistanceTransform::DistanceTransform(const AlgorithmServices& services)
{
    columns_ = services.pipelines->compute("distance.columns", {k_revectorized_distance_columns_comp},
                                           {sampledAt(0, kSeedFormat), bufferAt(1)}, sizeof(gpu::DistanceRect));
    rows_ = services.pipelines->compute("distance.rows", {k_revectorized_distance_rows_comp}, {bufferAt(1)},
                                        sizeof(gpu::DistanceRect));
}

BufferId DistanceTransform::declare(PassBuilder& passes, const CameraView& view, ImageId seeds,
                                    const VkRect2D& pixels) const
{
    // Of the view: lights take their turns with it.
    const BufferId sites =
        passes.transient(BufferInfo{.name = "distance.sites", .scope = Scope::view, .size = sitesOf(view.extent)});
    const gpu::DistanceRect rect{.left = static_cast<std::uint32_t>(pixels.offset.x),
                                 .top = static_cast<std::uint32_t>(pixels.offset.y),
                                 .width = pixels.extent.width,
                                 .height = pixels.extent.height};
    passes.compute("distance.columns").samples(seeds).writes(sites).record([=, pipeline = columns_](PassContext& gpu) {
        if (rect.width == 0) return;
        gpu.bind(pipeline, {gpu.sampled(0, seeds), gpu.storage(1, sites)});
        gpu.push(rect);
        gpu.vk->vkCmdDispatch(gpu.cmd, groupsOf(rect.width), 1, 1);
    });
    passes.compute("distance.rows").updates(sites).record([=, pipeline = rows_](PassContext& gpu) {
        if (rect.width == 0) return;
        gpu.bind(pipeline, {gpu.storage(1, sites)});
        gpu.push(rect);
        gpu.vk->vkCmdDispatch(gpu.cmd, groupsOf(rect.height), 1, 1);
    });
    return sites;
}

VkDeviceSize DistanceTransform::memory(VkExtent2D extent)
{
    return pooledSize(sitesOf(extent));
}

} // namespace gnomon
