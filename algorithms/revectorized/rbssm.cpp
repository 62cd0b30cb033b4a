// Soft shadows of lights with a radius from their depth map: the blockers around a receiver say how wide the penumbra
// is there, and a kernel as wide is laid over a map whose edges are lines.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 5.3; R.
// Fernando, "Percentage-closer soft shadows", SIGGRAPH 2005 sketches.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: contact and other narrow penumbrae in coarse maps.
// Weak at:   casters at several depths before one receiver; noise in wide penumbrae; cost.
#include "algorithms/entries.hpp"

#include "algorithms/revectorized/line_map.hpp"
#include "algorithms/shared/blocker_search.hpp"
#include "algorithms/shared/depth_bounds.hpp"
#include "shaders/revectorized/rbssm.h"
#include "shaders/revectorized_rbssm_cube_frag.h"
#include "shaders/revectorized_rbssm_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kTaps, kKernel, kLongest };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"taps", "Taps of the filter in wide penumbrae.", 8, gpu::MAX_SOFT_TAPS, 64},
    {"kernel", "Texels, odd: penumbrae that are no wider are filtered with revectorized edges.", 1, gpu::MAX_LINE_TAPS,
     7},
    kLongestSetting,
};

class Rbssm final : public ShadowAlgorithm {
public:
    explicit Rbssm(const AlgorithmServices& services)
        : vk_(*services.vk), casters_(makeDepthMapPipelines(services)), bounds_(services),
          soft_(services, {.name = "rbssm.resolve",
                           .fragment = k_revectorized_rbssm_frag,
                           .cube = k_revectorized_rbssm_cube_frag,
                           .filters = false,
                           .more = DepthBounds::kBinding}),
          hard_(services, "rbssm.hard")
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const auto longest = static_cast<std::uint32_t>(task.settings[kLongest]);
        if (!isSoft(*task.light)) { // rbsm's picture
            map_ = hard_.declare(passes, task, resolution, {.longest = longest});
            return;
        }
        gpu::RbssmConstants constants{};
        constants.base = mapConstants(task, resolution, 1);
        const LightMap map =
            declareLightMap(passes, casters_, task, resolution, constants.base, softBorder(resolution));
        map_ = handedOut(map.image, map.fits, map.needed, constants.base);
        constants.disc = discCone(*task.light, map.fits.front(), constants.base.map);
        constants.taps = static_cast<std::uint32_t>(task.settings[kTaps]);
        constants.kernel = filterSide(task.settings[kKernel]);
        constants.longest = longest;
        const BufferId bounds = bounds_.declare(passes, map, resolution);
        soft_.declare(passes, task, map.image, constants, {.more = {{{.buffer = bounds}}}});
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
    MapResolve soft_;
    LineMap hard_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kRbssm{
    .name = "rbssm",
    .source = "Macedo 2018, 5.3; Fernando 2005",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = searchedMapMemory,
    .create = makeAlgorithm<Rbssm>,
    .typicalWrongPercent = 0.37f, // of lights without a radius: rbsm's
};

} // namespace gnomon
