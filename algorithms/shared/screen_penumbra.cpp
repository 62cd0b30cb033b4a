#include "algorithms/shared/screen_penumbra.hpp"

#include <algorithm>
#include <array>

#include "algorithms/shared/disc_resolve.hpp"
#include "algorithms/shared/light_map.hpp"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kSteps };

// The plane's cosine to the light from which on the ellipse of a penumbra does not grow longer.
constexpr float kLeastCosine = 0.1f;

std::uint32_t sideOf(const ShadowTask& task)
{
    return static_cast<std::uint32_t>(task.settings[kResolution]);
}

} // namespace

ScreenPenumbra::ScreenPenumbra(const AlgorithmServices& services, const ScreenPenumbraInfo& info)
    : vk_(*services.vk), info_(info), casters_(makeDepthMapPipelines(services)), bounds_(services),
      blur_(services, info.rows, info.columns)
{
    GraphicsPipelineInfo pipeline;
    pipeline.name = info.seen;
    pipeline.vertex.code = k_shared_map_resolve_vert;
    pipeline.fragment.specializationCount = 1;
    pipeline.colorFormat = ScreenBlur::kSeenFormat;
    for (const bool cube : {false, true}) {
        std::array<BindingInfo, 5> bindings{};
        std::ranges::copy(lookupBindings(cube), bindings.begin());
        bindings[4] = {.binding = 1, .kind = BindingKind::storageBuffer};
        pipeline.bindings = bindings;
        pipeline.fragment.code = info.soft[cube];
        for (std::uint32_t normals = 0; normals < 2; ++normals) {
            pipeline.fragment.specialization[0] = normals;
            seen_[cube][normals] = services.pipelines->graphics(pipeline);
        }
    }
}

void ScreenPenumbra::declare(PassBuilder& passes, const ShadowTask& task)
{
    if (isSoft(*task.light)) return declareSoft(passes, task);
    map_ = declareHard(passes, task);
}

void ScreenPenumbra::declareSoft(PassBuilder& passes, const ShadowTask& task)
{
    const std::uint32_t resolution = sideOf(task);
    const LightView& light = *task.light;
    const bool cube = light.type == GN_LIGHT_TYPE_POINT;
    gpu::ScreenPenumbraConstants& constants = *passes.arena().make<gpu::ScreenPenumbraConstants>();
    constants.base = mapConstants(task, resolution, 1);
    const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base, softBorder(resolution));
    map_ = handedOut(map.image, map.fits, map.needed, constants.base);
    constants.hard = info_.look;
    constants.disc = discCone(light, map.fits.front(), constants.base.map);
    constants.light = light.constants;
    constants.steps = static_cast<std::uint32_t>(task.settings[kSteps]);
    constants.leastCosine = kLeastCosine;
    const BufferId bounds = bounds_.declare(passes, map, resolution);
    const ImageId seen = ScreenBlur::declareSeen(passes, task);
    const LookupImages look(task, map.image);
    LookupPass pass(passes, task, info_.seen, look, seen, ScreenBlur::kNotAsked);
    pass.uses.reads(bounds);
    pass.record([=, pipeline = seen_[cube][look.hasNormals], block = &constants](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *block), gpu.storage(1, bounds), gpu.sampled(2, look.depth),
                            gpu.sampled(3, look.normals), gpu.sampled(4, look.map, SamplerKind::nearestBorderFar)});
    });
    blur_.declare(passes, task, seen, constants);
}

const char* ScreenPenumbra::refuses(const ShadowTask& task) const
{
    return refusesSearch(vk_, task, sideOf(task));
}

VkDeviceSize ScreenPenumbra::memory(std::span<const double> settings, VkExtent2D extent, GnLightType type)
{
    const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
    const std::uint32_t layers = mapLayers(type);
    return depthMapMemory(resolution, layers) + DepthBounds::memory(resolution, layers) + ScreenBlur::memory(extent);
}

} // namespace gnomon
