#include "algorithms/shared/screen_penumbra.hpp"

#include "algorithms/shared/light_map.hpp"

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
    : vk_(*services.vk), hard_(info.look), casters_(makeDepthMapPipelines(services)), bounds_(services),
      blur_(services, info.rows, info.columns), seen_(services, {.name = info.seen,
                                                                 .fragment = info.soft[0],
                                                                 .cube = info.soft[1],
                                                                 .filters = false,
                                                                 .more = DepthBounds::kBinding,
                                                                 .format = ScreenBlur::kSeenFormat})
{
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
    gpu::ScreenPenumbraConstants& constants = *passes.arena().make<gpu::ScreenPenumbraConstants>();
    constants.base = mapConstants(task, resolution, 1);
    const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base, softBorder(resolution));
    map_ = handedOut(map.image, map.fits, map.needed, constants.base);
    constants.hard = hard_;
    constants.disc = discCone(light, map.fits.front(), constants.base.map);
    constants.light = light.constants;
    constants.steps = static_cast<std::uint32_t>(task.settings[kSteps]);
    constants.leastCosine = kLeastCosine;
    const BufferId bounds = bounds_.declare(passes, map, resolution);
    const ImageId seen = ScreenBlur::declareSeen(passes, task);
    seen_.declare(passes, task, map.image, constants,
                  {.more = {{{.buffer = bounds}}}, .target = seen, .otherwise = ScreenBlur::kNotAsked});
    blur_.declare(passes, task, seen, constants);
}

const char* ScreenPenumbra::refuses(const ShadowTask& task) const
{
    return refusesSearch(vk_, task, sideOf(task));
}

VkDeviceSize ScreenPenumbra::memory(std::span<const double> settings, VkExtent2D extent, GnLightType type)
{
    return searchedMapMemory(settings, extent, type) + ScreenBlur::memory(extent);
}

} // namespace gnomon
