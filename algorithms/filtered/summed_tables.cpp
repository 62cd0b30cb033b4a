#include "algorithms/filtered/summed_tables.hpp"

#include "algorithms/filtered/moment_maps.hpp"
#include "algorithms/shared/caster_lists.hpp"
#include "shaders/filtered/summed.h"
#include "shaders/filtered_summed_columns_comp.h"
#include "shaders/filtered_summed_rows_comp.h"

namespace gnomon {

namespace {

constexpr VkFormat kTableFormat = VK_FORMAT_R32G32B32A32_UINT;
constexpr VkDeviceSize kEntryBytes = 16;

} // namespace

SummedTables::SummedTables(const AlgorithmServices& services)
{
    rows_ = services.pipelines->compute("moments_soft.rows", {k_filtered_summed_rows_comp},
                                        {constantsAt(0), mapAt(1, kMapFormat), bufferAt(2)});
    columns_ = services.pipelines->compute("moments_soft.columns", {k_filtered_summed_columns_comp},
                                           {constantsAt(0), bufferAt(1), storedMapAt(2, kTableFormat)});
}

ImageId SummedTables::declare(PassBuilder& passes, const LightMap& map, const ShadowTask& task,
                              std::uint32_t resolution) const
{
    const auto layers = static_cast<std::uint32_t>(map.fits.size());
    const ImageId table = passes.persistent(ImageInfo{.name = "moments_soft.table",
                                                      .scope = Scope::light,
                                                      .format = kTableFormat,
                                                      .extent = {resolution, resolution},
                                                      .layers = layers,
                                                      .variant = resolution});
    const std::uint32_t groups = (resolution + gpu::BOX_GROUP - 1) / gpu::BOX_GROUP;
    for (std::uint32_t index = 0; index < layers; ++index) {
        if ((map.needed >> index & 1) == 0) continue;
        const std::uint32_t variant = index << 16 | resolution;
        const gpu::LinearDepth linear = linearDepthOf(map.fits[index], *task.light); // follows all casters in range
        const std::uint64_t made = Stamp().add(map.stamps[index]).add(linear.scale).value();
        if (!staleLayer(passes, "moments_soft.stamp", Scope::light, variant, table, made)) continue;
        const BufferId sums = passes.transient(BufferInfo{.name = "moments_soft.sums",
                                                          .scope = Scope::light,
                                                          .size = kEntryBytes * gpu::boxTexels(resolution),
                                                          .variant = resolution});
        gpu::BoxSums* along = passes.arena().make<gpu::BoxSums>();
        along->linear = linear;
        along->side = resolution;
        gpu::BoxSums* down = passes.arena().make(*along);
        down->columns = 1;
        passes.compute("moments_soft.rows", Scope::light, variant)
            .samples(map.image, {.layer = index})
            .writes(sums)
            .record([=, image = map.image, pipeline = rows_](PassContext& gpu) {
                gpu.bind(pipeline, {gpu.constants(0, *along), gpu.sampled(1, image, SamplerKind::nearest, index),
                                    gpu.storage(2, sums)});
                gpu.vk->vkCmdDispatch(gpu.cmd, groups, 1, 1);
            });
        passes.compute("moments_soft.columns", Scope::light, variant)
            .reads(sums)
            .writes(table, {.layer = index})
            .record([=, pipeline = columns_](PassContext& gpu) {
                gpu.bind(pipeline, {gpu.constants(0, *down), gpu.storage(1, sums), gpu.storage(2, table, index)});
                gpu.vk->vkCmdDispatch(gpu.cmd, groups, 1, 1);
            });
    }
    return table;
}

VkDeviceSize SummedTables::memory(std::uint32_t resolution, std::uint32_t layers)
{
    return storedImageSize({resolution, resolution}, kEntryBytes) * layers +
           pooledSize(kEntryBytes * gpu::boxTexels(resolution));
}

} // namespace gnomon
