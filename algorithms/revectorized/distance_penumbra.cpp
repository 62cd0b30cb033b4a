#include "algorithms/revectorized/distance_penumbra.hpp"

#include <algorithm>
#include <array>

#include "algorithms/revectorized/line_map.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/revectorized_distance_hard_cube_frag.h"
#include "shaders/revectorized_distance_hard_frag.h"
#include "shaders/revectorized_distance_resolve_frag.h"
#include "shaders/revectorized_distance_seeds_cube_frag.h"
#include "shaders/revectorized_distance_seeds_frag.h"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

namespace {

constexpr VkFormat kStateFormat = VK_FORMAT_R8_UNORM;
/// Taps of the mean to each side: 15 x 15 (Macedo 2018, 4.3).
constexpr std::uint32_t kMeanSteps = 7;
/// Of an ellipse about the light's direction, as screen_penumbra has it; a ramp of one width has a circle.
constexpr float kLeastCosine = 0.1f;
constexpr BindingInfo kStates{.binding = 5, .kind = BindingKind::sampledImage, .format = kStateFormat};

/// Full-screen pipelines with and without normals.
void makePipelines(const AlgorithmServices& services, GraphicsPipelineInfo info, PipelineId (&pipelines)[2])
{
    info.vertex.code = k_shared_map_resolve_vert;
    info.fragment.specializationCount = 1;
    for (std::uint32_t normals = 0; normals < 2; ++normals) {
        info.fragment.specialization[0] = normals;
        pipelines[normals] = services.pipelines->graphics(info);
    }
}

/// The task with another image in visibility's place, of one layer.
ShadowTask writing(const ShadowTask& task, ImageId image)
{
    ShadowTask other = task;
    other.visibility = image;
    other.layer = 0;
    return other;
}

} // namespace

DistancePenumbra::DistancePenumbra(const AlgorithmServices& services)
    : vk_(*services.vk), casters_(makeDepthMapPipelines(services)),
      hard_{{services, {.name = "distance.hard", .fragment = k_revectorized_distance_hard_frag}},
            {services, {.name = "distance.hard", .fragment = k_revectorized_distance_hard_cube_frag, .layers = true}}},
      transform_(services), mean_(services, "distance.mean_rows", "distance.mean_columns")
{
    for (const bool point : {false, true}) {
        const std::array look = lookupBindings(point);
        std::array<BindingInfo, look.size() + 1> bindings{};
        std::ranges::copy(look, bindings.begin());
        bindings.back() = kStates;
        makePipelines(
            services,
            {.name = "distance.seeds",
             .fragment = {.code = point ? std::span<const std::uint32_t>(k_revectorized_distance_seeds_cube_frag)
                                        : std::span<const std::uint32_t>(k_revectorized_distance_seeds_frag)},
             .bindings = bindings,
             .colorFormat = kSeedFormat},
            seeds_[point]);
    }
    const std::array look = lookupBindings(false);
    const std::array bindings = {look[0],
                                 look[1],
                                 look[2],
                                 kStates,
                                 BindingInfo{.binding = 6, .kind = BindingKind::sampledImage, .format = kSeedFormat},
                                 BindingInfo{.binding = 7, .kind = BindingKind::storageBuffer}};
    for (const bool mean : {false, true})
        makePipelines(services,
                      {.name = "distance.ramp",
                       .fragment = {.code = k_revectorized_distance_resolve_frag},
                       .bindings = bindings,
                       .colorFormat = mean ? ScreenBlur::kSeenFormat : VK_FORMAT_R8_UNORM},
                      ramp_[mean]);
}

ShadowAlgorithm::Map DistancePenumbra::declare(PassBuilder& passes, const ShadowTask& task,
                                               const DistanceRamp& ramp) const
{
    const auto resolution = static_cast<std::uint32_t>(task.settings[0]);
    const bool point = task.light->type == GN_LIGHT_TYPE_POINT;
    gpu::MapConstants base = mapConstants(task, resolution, 1);
    const LightMap map = declareLightMap(passes, casters_, task, resolution, base,
                                         lineBorder(*task.light, resolution, {.longest = gpu::LONGEST_STAIR}));
    const ShadowAlgorithm::Map handed = handedOut(map.image, map.fits, map.needed, base);
    if (ramp.width <= 0.0f && ramp.disc <= 0.0f) {
        hard_[point].declare(passes, task, map.image, base, false);
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
    Images images;
    images.states = passes.transient(image);
    image.name = "distance.seeds";
    image.format = kSeedFormat;
    images.seeds = passes.transient(image);
    hard_[point].declare(passes, writing(task, images.states), map.image, base, true);
    declareSeeds(passes, writing(task, images.seeds), map.image, images, constants);
    images.sites = transform_.declare(passes, *task.view, images.seeds, pixels);
    declareRamp(passes, task, images, constants);
    return handed;
}

void DistancePenumbra::declareSeeds(PassBuilder& passes, const ShadowTask& task, ImageId map, const Images& images,
                                    const gpu::DistanceConstants& constants) const
{
    const LookupImages look(task, map);
    const PipelineId pipeline = seeds_[task.light->type == GN_LIGHT_TYPE_POINT][look.hasNormals];
    LookupPass pass(passes, task, "distance.seeds", look);
    pass.uses.samples(images.states);
    pass.record([=, states = images.states, block = passes.arena().make(constants)](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *block), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                            gpu.sampled(4, look.map, SamplerKind::nearestBorderFar), gpu.sampled(5, states)});
    });
}

void DistancePenumbra::declareRamp(PassBuilder& passes, const ShadowTask& task, const Images& images,
                                   const gpu::DistanceConstants& constants) const
{
    const LookupImages look(task, images.states);
    const bool mean = constants.mean > 0.0f;
    const PipelineId pipeline = ramp_[mean][look.hasNormals];
    const ImageId seen = mean ? ScreenBlur::declareSeen(passes, task) : ImageId{};
    LookupPass pass = mean ? LookupPass(passes, task, "distance.ramp", look, seen, ScreenBlur::kNotAsked)
                           : LookupPass(passes, task, "distance.ramp", look);
    pass.uses.samples(images.seeds).reads(images.sites);
    pass.record([=, block = passes.arena().make(constants)](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *block), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                            gpu.sampled(5, images.states), gpu.sampled(6, images.seeds), gpu.storage(7, images.sites)});
    });
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
