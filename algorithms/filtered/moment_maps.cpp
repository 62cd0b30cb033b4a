#include "algorithms/filtered/moment_maps.hpp"

#include <algorithm>
#include <bit>

#include "algorithms/shared/caster_lists.hpp"
#include "shaders/filtered_box_means_comp.h"
#include "shaders/filtered_moments_columns1_comp.h"
#include "shaders/filtered_moments_columns2_comp.h"
#include "shaders/filtered_moments_columns4_comp.h"
#include "shaders/filtered_moments_levels1_comp.h"
#include "shaders/filtered_moments_levels2_comp.h"
#include "shaders/filtered_moments_levels4_comp.h"
#include "shaders/filtered_moments_rows_comp.h"

namespace gnomon {

namespace {

constexpr std::array kWordFormats = {VK_FORMAT_R32_UINT, VK_FORMAT_R16G16B16A16_UINT, VK_FORMAT_R32G32B32A32_UINT};

std::uint32_t wordsOf(const MomentFilter& filter)
{
    const std::uint32_t channels = gpu::momentChannels(filter.kind);
    return filter.bits == 16 ? (channels + 1) / 2 : channels;
}

/// 1, 2, 4 -> 0, 1, 2.
std::size_t logOf(std::uint32_t count)
{
    return static_cast<std::size_t>(std::countr_zero(count));
}

PipelineId columnsPipeline(const AlgorithmServices& services, std::uint32_t channels, std::uint32_t words)
{
    const std::span<const std::uint32_t> codes[] = {k_filtered_moments_columns1_comp, k_filtered_moments_columns2_comp,
                                                    k_filtered_moments_columns4_comp};
    return services.pipelines->compute(
        "moments.columns", {codes[logOf(words)], 1, {channels}},
        {constantsAt(0), bufferAt(1), bufferAt(2), storedMapAt(3, kWordFormats[logOf(words)])});
}

PipelineId levelsPipeline(const AlgorithmServices& services, std::uint32_t words)
{
    const std::span<const std::uint32_t> codes[] = {k_filtered_moments_levels1_comp, k_filtered_moments_levels2_comp,
                                                    k_filtered_moments_levels4_comp};
    const VkFormat format = kWordFormats[logOf(words)];
    return services.pipelines->compute("moments.levels", {codes[logOf(words)]},
                                       {constantsAt(0), mapAt(1, format), storedMapAt(2, format)});
}

VkExtent2D levelsExtent(std::uint32_t resolution)
{
    const gpu::uvec2 extent = gpu::momentLevelsExtent(resolution);
    return {extent.x, extent.y};
}

/// Whichever tasks make the same of the same map share it.
std::uint32_t variantOf(const MomentFilter& filter, std::uint32_t resolution)
{
    const std::uint64_t hash = Stamp()
                                   .add(std::uint64_t{filter.kind << 16 | filter.bits << 8 | filter.boxes})
                                   .add(std::uint64_t{filter.mips})
                                   .add(std::uint64_t{filter.box} << 32 | resolution)
                                   .add(filter.exponent)
                                   .value();
    return static_cast<std::uint32_t>(hash ^ hash >> 32) & ~7u; // with room for a layer
}

} // namespace

gpu::LinearDepth linearDepthOf(const LightFit& fit, const LightView& light)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL)
        return {.scale = 1.0f, .offset = 0.0f, .perspective = 0.0f, .padding = 0.0f};
    // At the light, not at the near end: what is before that end appears on it.
    const float scale = fit.nearWs / std::max(fit.endWs, 2.0f * fit.nearWs);
    return {.scale = scale, .offset = 0.0f, .perspective = 1.0f, .padding = 0.0f};
}

bool staleLayer(PassBuilder& passes, const char* stampName, Scope scope, std::uint32_t variant, ImageId image,
                std::uint64_t mapStamp)
{
    // A stamp belongs to a whole resource, layers need one each: the smallest buffer there is carries it.
    const BufferId carrier =
        passes.persistent(BufferInfo{.name = stampName, .scope = scope, .size = 4, .variant = variant});
    if (passes.stale(carrier, Stamp().add(mapStamp).add(passes.serial(image)).value())) return true;
    passes.kept();
    return false;
}

/// One layer of a map and what its moments are made in.
struct MomentMaps::Layer {
    MomentFilter filter;
    ImageId map;
    MomentImages moments;
    BufferId first, second; ///< Scratch.
    Scope scope;            ///< LightMap::scope
    std::uint32_t index = 0, side = 0, variant = 0;
    gpu::BoxSums rows{}, columns{};

    /// Of BOX_GROUP invocations, an invocation for each run of a row. In two dimensions: Vulkan promises 65 535 in one.
    void dispatch(PassContext& gpu) const
    {
        gpu.vk->vkCmdDispatch(gpu.cmd, (side + gpu::BOX_GROUP - 1) / gpu::BOX_GROUP,
                              (side + filter.box - 1) / filter.box, 1);
    }
};

MomentMaps::MomentMaps(const AlgorithmServices& services)
{
    for (std::uint32_t kind = 0; kind < gpu::MOMENT_KINDS; ++kind)
        rows_[kind] = services.pipelines->compute("moments.rows", {k_filtered_moments_rows_comp, 1, {kind}},
                                                  {constantsAt(0), mapAt(1, kMapFormat), bufferAt(2)});
    for (std::uint32_t channels = 1; channels <= 4; channels *= 2) {
        means_[logOf(channels)] = services.pipelines->compute(
            "moments.means", {k_filtered_box_means_comp, 1, {channels}}, {constantsAt(0), bufferAt(1), bufferAt(2)});
        for (const std::uint32_t words : {(channels + 1) / 2, channels})
            columns_[logOf(channels)][logOf(words)] = columnsPipeline(services, channels, words);
        levels_[logOf(channels)] = levelsPipeline(services, channels);
    }
}

MomentImages MomentMaps::declare(PassBuilder& passes, const LightMap& map, const ShadowTask& task,
                                 std::uint32_t resolution, const MomentFilter& filter) const
{
    const std::uint32_t variant = variantOf(filter, resolution);
    const auto layers = static_cast<std::uint32_t>(map.fits.size());
    ImageInfo info{.name = "moments.map",
                   .scope = map.scope,
                   .format = format(filter),
                   .extent = {resolution, resolution},
                   .layers = layers,
                   .variant = variant};
    MomentImages moments{.map = passes.persistent(info), .levels = {}};
    if (filter.mips) {
        info.name = "moments.smaller";
        info.extent = levelsExtent(resolution);
        moments.levels = passes.persistent(info);
    }
    for (std::uint32_t index = 0; index < layers; ++index) {
        if ((map.needed >> index & 1) == 0) continue;
        const gpu::LinearDepth linear = linearDepthOf(map.fits[index], *task.light); // follows all casters in range
        Stamp made = Stamp().add(map.stamps[index]).add(linear.scale);
        if (filter.mips) made.add(passes.serial(moments.levels));
        if (!staleLayer(passes, "moments.stamp", map.scope, variant + index, moments.map, made.value())) continue;
        const auto scratch = [&](const char* name) {
            return passes.transient(BufferInfo{
                .name = name, .scope = map.scope, .size = scratchBytes(filter, resolution), .variant = variant});
        };
        Layer layer{.filter = filter,
                    .map = map.image,
                    .moments = moments,
                    .first = scratch("moments.first"),
                    .second = scratch("moments.second"),
                    .scope = map.scope,
                    .index = index,
                    .side = resolution,
                    .variant = variant + index};
        layer.rows = {.linear = linear,
                      .exponent = filter.exponent,
                      .side = resolution,
                      .box = filter.box,

                      .columns = 0,
                      .kind = filter.kind,
                      .bits = filter.bits,
                      .padding0 = 0,
                      .padding1 = 0};
        layer.columns = layer.rows;
        layer.columns.columns = 1;
        declareLayer(passes, layer);
    }
    return moments;
}

void MomentMaps::declareLayer(PassBuilder& passes, const Layer& declared) const
{
    static constexpr const char* kMeans[] = {"moments.rows2", "moments.rows3", "moments.columns1", "moments.columns2"};
    const Layer* layer = passes.arena().make(declared);
    const std::size_t channels = logOf(gpu::momentChannels(layer->filter.kind));
    BufferId from = layer->first, to = layer->second;
    passes.compute("moments.rows", layer->scope, layer->variant)
        .samples(layer->map, {.layer = layer->index})
        .updates(from)
        .record([layer, from, pipeline = rows_[layer->filter.kind]](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, layer->rows),
                                gpu.sampled(1, layer->map, SamplerKind::nearest, layer->index), gpu.storage(2, from)});
            layer->dispatch(gpu);
        });
    // Rows that remain, then columns but the last.
    const std::uint32_t more = layer->filter.boxes - 1;
    for (std::uint32_t i = 0; i < 2 * more; ++i) {
        const bool columns = i >= more;
        passes.compute(kMeans[columns ? 2 + i - more : i], layer->scope, layer->variant)
            .reads(from)
            .updates(to)
            .record([layer, from, to, columns, pipeline = means_[channels]](PassContext& gpu) {
                gpu.bind(pipeline, {gpu.constants(0, columns ? layer->columns : layer->rows), gpu.storage(1, from),
                                    gpu.storage(2, to)});
                layer->dispatch(gpu);
            });
        std::swap(from, to);
    }
    passes.compute("moments.columns", layer->scope, layer->variant)
        .reads(from)
        .updates(to)
        .writes(layer->moments.map, {.layer = layer->index})
        .record([layer, from, to, pipeline = columns_[channels][logOf(wordsOf(layer->filter))]](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, layer->columns), gpu.storage(1, from), gpu.storage(2, to),
                                gpu.storage(3, layer->moments.map, layer->index)});
            layer->dispatch(gpu);
        });
    if (layer->filter.mips) declareLevels(passes, layer);
}

void MomentMaps::declareLevels(PassBuilder& passes, const Layer* layer) const
{
    passes.compute("moments.levels", layer->scope, layer->variant)
        .samples(layer->moments.map, {.layer = layer->index})
        .writes(layer->moments.levels, {.layer = layer->index})
        .record([layer, pipeline = levels_[logOf(wordsOf(layer->filter))]](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, layer->columns),
                                gpu.sampled(1, layer->moments.map, SamplerKind::nearest, layer->index),
                                gpu.storage(2, layer->moments.levels, layer->index)});
            const std::uint32_t groups = (layer->side + gpu::MOMENT_LEVELS_TILE - 1) / gpu::MOMENT_LEVELS_TILE;
            gpu.vk->vkCmdDispatch(gpu.cmd, groups, groups, 1);
        });
}

VkDeviceSize MomentMaps::memory(const MomentFilter& filter, std::uint32_t resolution, std::uint32_t layers)
{
    const VkDeviceSize texel = 4 * wordsOf(filter);
    const VkDeviceSize levels = filter.mips ? storedImageSize(levelsExtent(resolution), texel) : 0;
    return (storedImageSize({resolution, resolution}, texel) + levels) * layers +
           2 * pooledSize(scratchBytes(filter, resolution));
}

VkDeviceSize MomentMaps::scratchBytes(const MomentFilter& filter, std::uint32_t resolution)
{
    return VkDeviceSize{4} * gpu::momentChannels(filter.kind) * gpu::boxTexels(resolution);
}

VkFormat MomentMaps::format(const MomentFilter& filter)
{
    return kWordFormats[logOf(wordsOf(filter))];
}

} // namespace gnomon
