#include "algorithms/revectorized/distance_penumbra.hpp"

#include <algorithm>

#include "algorithms/revectorized/line_map.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/revectorized_distance_columns_comp.h"
#include "shaders/revectorized_distance_hard_cube_frag.h"
#include "shaders/revectorized_distance_hard_frag.h"
#include "shaders/revectorized_distance_resolve_frag.h"
#include "shaders/revectorized_distance_rows_comp.h"
#include "shaders/revectorized_distance_seeds_cube_frag.h"
#include "shaders/revectorized_distance_seeds_frag.h"

namespace gnomon {

namespace {

constexpr VkFormat kStateFormat = VK_FORMAT_R8_UNORM;
/// Taps of the mean to each side: 15 x 15 (Macedo 2018, 4.3).
constexpr std::uint32_t kMeanSteps = 7;
/// Of an ellipse about the light's direction, as screen_penumbra has it; a ramp of one width has a circle.
constexpr float kLeastCosine = 0.1f;

/// States, which are all that seeds are made of beside the map, seeds and sites.
constexpr BindingInfo kRampInputs[] = {
    sampledAt(5, kStateFormat),
    sampledAt(6, kSeedFormat),
    bufferAt(7),
};

MapResolve makeRamp(const AlgorithmServices& services, VkFormat format)
{
    return {services,
            {.name = "distance.ramp",
             .fragment = k_revectorized_distance_resolve_frag,
             .filters = false,
             .more = kRampInputs,
             .format = format}};
}

/// The task with another image in visibility's place, of one layer.
ShadowTask writing(const ShadowTask& task, ImageId image)
{
    ShadowTask other = task;
    other.visibility = image;
    other.layer = 0;
    return other;
}

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

DistancePenumbra::DistancePenumbra(const AlgorithmServices& services)
    : vk_(*services.vk), casters_(makeDepthMapPipelines(services)),
      hard_(services, {.name = "distance.hard",
                       .fragment = k_revectorized_distance_hard_frag,
                       .cube = k_revectorized_distance_hard_cube_frag}),
      transform_(services), mean_(services, "distance.mean_rows", "distance.mean_columns"),
      seeds_(services, {.name = "distance.seeds",
                        .fragment = k_revectorized_distance_seeds_frag,
                        .cube = k_revectorized_distance_seeds_cube_frag,
                        .filters = false,
                        .more = std::span(kRampInputs).first(1),
                        .format = kSeedFormat}),
      ramp_{makeRamp(services, VK_FORMAT_R8_UNORM), makeRamp(services, ScreenBlur::kSeenFormat)}
{
}

ShadowAlgorithm::Map DistancePenumbra::declare(PassBuilder& passes, const ShadowTask& task,
                                               const DistanceRamp& ramp) const
{
    const auto resolution = static_cast<std::uint32_t>(task.settings[0]);
    gpu::MapConstants base = mapConstants(task, resolution, 1);
    const LightMap map = declareLightMap(passes, casters_, task, resolution, base,
                                         lineBorder(*task.light, resolution, {.longest = gpu::LONGEST_STAIR}));
    const ShadowAlgorithm::Map handed = handedOut(map.image, map.fits, map.needed, base);
    if (ramp.width <= 0.0f && ramp.disc <= 0.0f) {
        hard_.declare(passes, task, map.image, base, {});
        return handed;
    }
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    const gpu::DistanceConstants constants{
        .base = base,
        .rect = glm::uvec4(pixels.offset.x, pixels.offset.y, pixels.extent.width, pixels.extent.height),
        .width = ramp.width,
        .disc = ramp.disc,
        .show = ramp.show,
        .mean = ramp.show == gpu::SHOW_VISIBILITY ? ramp.mean : 0.0f};
    // Of the view: lights take their turns with them.
    ImageInfo image{
        .name = "distance.states", .scope = Scope::view, .format = kStateFormat, .extent = task.view->extent};
    Images images{.map = map.image};
    images.states = passes.transient(image);
    image.name = "distance.seeds";
    image.format = kSeedFormat;
    images.seeds = passes.transient(image);
    hard_.declare(passes, writing(task, images.states), map.image, base, {.filtered = true});
    seeds_.declare(passes, writing(task, images.seeds), map.image, constants, {.more = {{{.image = images.states}}}});
    images.sites = transform_.declare(passes, *task.view, images.seeds, pixels);
    declareRamp(passes, task, images, constants);
    return handed;
}

void DistancePenumbra::declareRamp(PassBuilder& passes, const ShadowTask& task, const Images& images,
                                   const gpu::DistanceConstants& constants) const
{
    const bool mean = constants.mean > 0.0f;
    const ImageId seen = mean ? ScreenBlur::declareSeen(passes, task) : ImageId{};
    ramp_[mean].declare(passes, task, images.map, constants,
                        {.more = {{{.image = images.states}, {.image = images.seeds}, {.buffer = images.sites}}},
                         .target = seen,
                         .otherwise = ScreenBlur::kNotAsked});
    if (!mean) return;
    auto* const block = passes.arena().make<gpu::ScreenPenumbraConstants>();
    block->base = constants.base;
    block->light = task.light->constants;
    block->steps = kMeanSteps;
    block->leastCosine = constants.width > 0.0f ? 1.0f : kLeastCosine;
    mean_.declare(passes, task, seen, *block);
}

const char* DistancePenumbra::refuses(const ShadowTask& task) const
{
    const VkExtent2D extent = task.view->extent;
    if (std::max(extent.width, extent.height) > gpu::MAX_DISTANCE_SIDE)
        return "its distances reach over 16384 pixels a side at most";
    if (DistanceTransform::memory(extent) > vk_.properties.limits.maxStorageBufferRange)
        return "its distances are larger than a storage buffer may be";
    return nullptr;
}

VkDeviceSize DistancePenumbra::memory(std::uint32_t resolution, VkExtent2D extent, GnLightType type, double mean)
{
    return depthMapMemory(resolution, mapLayers(type)) + storedImageSize(extent, 1) + storedImageSize(extent, 4) +
           DistanceTransform::memory(extent) + (mean > 0.0 ? ScreenBlur::memory(extent) : 0);
}

} // namespace gnomon
