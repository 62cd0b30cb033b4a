// Soft shadows of lights with a radius from their depth map: the blockers around a receiver say how wide the penumbra
// is there, and as many texels are filtered.
// Source:    R. Fernando, "Percentage-closer soft shadows", SIGGRAPH 2005 sketches; G. Guennebaud, L. Barthe, M.
//            Paulin, "Real-time soft shadow mapping by backprojection", EGSR 2006 (nearest and farthest depths).
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: penumbrae that widen with the distance from the caster, for the price of a map; all kinds of light.
// Weak at:   casters at several depths before one receiver; noise in wide penumbrae; edges as fine as texels are.
#include "algorithms/entries.hpp"

#include "algorithms/shared/blocker_search.hpp"
#include "algorithms/shared/depth_bounds.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/filtered/pcss.h"
#include "shaders/filtered_nearest_cube_frag.h"
#include "shaders/filtered_nearest_frag.h"
#include "shaders/filtered_pcss_cube_frag.h"
#include "shaders/filtered_pcss_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kTaps, kEarly, kReasons };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"taps", "Taps of the filter, spread over the penumbra.", 8, gpu::MAX_SOFT_TAPS, 64},
    {"early", "1: pixels that the nearest and farthest depths around them decide are not searched. 0: all are.", 0, 1,
     1},
    {"reasons", "1: the byte in visibility is why a pixel is lit or dark: a code of shaders/filtered/pcss.h.", 0, 1, 0},
};

class Pcss final : public ShadowAlgorithm {
public:
    explicit Pcss(const AlgorithmServices& services)
        : vk_(*services.vk), casters_(makeDepthMapPipelines(services)), bounds_(services),
          resolve_(services, {.name = "pcss.resolve",
                              .fragment = k_filtered_pcss_frag,
                              .cube = k_filtered_pcss_cube_frag,
                              .filters = false,
                              .more = DepthBounds::kBinding}),
          hard_(services, {.name = "pcss.hard",
                           .fragment = k_filtered_nearest_frag,
                           .cube = k_filtered_nearest_cube_frag,
                           .filters = false})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const LightView& light = *task.light;
        const bool soft = isSoft(light);
        gpu::PcssConstants constants{};
        constants.base = mapConstants(task, resolution, 1);
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base,
                                             soft ? softBorder(resolution) : kMapBorderTexels);
        map_ = handedOut(map.image, map.fits, map.needed, constants.base);
        if (!soft) { // shadow_map's picture, or cube_map's
            hard_.declare(passes, task, map.image, constants.base);
            return;
        }
        constants.disc = discCone(light, map.fits.front(), constants.base.map);
        constants.taps = static_cast<std::uint32_t>(task.settings[kTaps]);
        constants.early = task.settings[kEarly] != 0.0;
        constants.reasons = task.settings[kReasons] != 0.0;
        const BufferId bounds = bounds_.declare(passes, map, resolution);
        resolve_.declare(passes, task, map.image, constants, {.more = {{{.buffer = bounds}}}});
    }

    const char* refuses(const ShadowTask& task) const override
    {
        return refusesSearch(vk_, task, static_cast<std::uint32_t>(task.settings[kResolution]));
    }
    const Map* lightMap() const override { return &map_; }

private:
    const DeviceTable& vk_;
    DepthMapPipelines casters_;
    DepthBounds bounds_;
    MapResolve resolve_, hard_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kPcss{
    .name = "pcss",
    .source = "Fernando 2005; Guennebaud, Barthe and Paulin 2006",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = searchedMapMemory,
    .create = makeAlgorithm<Pcss>,
    .typicalWrongPercent = 0.54f, // of lights without a radius: shadow_map's
};

} // namespace gnomon
