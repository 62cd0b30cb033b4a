// Soft shadows of lights with a radius from summed-area tables of moments: VSSM and MSSM.
// Source:    B. Yang, Z. Dong, J. Feng, H.-P. Seidel and J. Kautz, "Variance soft shadow mapping", CGF 29, 2010;
//            C. Peters, C. Muenstermann, N. Wetzstein and R. Klein, "Beyond hard shadows: moment shadow maps for single
//            scattering, soft shadows and translucent occluders", I3D 2016.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: penumbrae that widen with distance, at a price that does not depend on their width.
// Weak at:   light leaks where casters overlap; one caster before another widens the other's penumbra.
#include "algorithms/entries.hpp"

#include <glm/geometric.hpp>

#include "algorithms/filtered/moment_maps.hpp"
#include "algorithms/filtered/summed_tables.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/source_size.hpp"
#include "shaders/filtered/summed.h"
#include "shaders/filtered_moments_soft_cube_frag.h"
#include "shaders/filtered_moments_soft_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kFour, kBleeding };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, gpu::MAX_TABLE_SIDE, 1024,
     true},
    {"moments", "0: two, the mean and the variance (VSSM). 1: four (MSSM).", 0, 1, 1},
    {"bleeding", "Share of light below which a pixel counts as umbra.", 0, 0.9, 0},
};

/// Half of the widest box and a texel.
constexpr std::uint32_t kBorderTexels = 33;
// What four moments are off by, each rounded to 2^-20 before it is summed: 2^-21 at most. Peters and Klein 2015 have
// 6e-5 for 2^-17 and a mapping that gains three bits.
constexpr float kMomentBias = 1e-5f;
// The root of what a variance is off by, 2^-20.
constexpr float kDeviation = 0x1p-10f;

constexpr BindingInfo kTable[] = {momentsAt(5)};

class MomentsSoft final : public ShadowAlgorithm {
public:
    explicit MomentsSoft(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)), tables_(services),
          resolve_(services, {.name = "moments_soft.resolve",
                              .fragment = k_filtered_moments_soft_frag,
                              .cube = k_filtered_moments_soft_cube_frag,
                              .filters = false,
                              .more = kTable})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        gpu::SoftConstants constants{};
        constants.base = mapConstants(task, resolution, 1);
        // Without a radius the picture is that of a plain map, from the very same texels.
        const std::uint32_t border = task.light->constants.sourceRadius > 0.0f ? kBorderTexels : kMapBorderTexels;
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base, border);
        const ImageId table = tables_.declare(passes, map, task, resolution);
        addLight(constants, map.fits.front(), task);
        map_ = handedOut(map.image, map.fits, map.needed, constants.base);
        resolve_.declare(passes, task, map.image, constants, {.more = {{{.image = table}}}});
    }

    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }
    const Map* lightMap() const override { return &map_; }

private:
    /// All layers of a map have the same ends and texels.
    static void addLight(gpu::SoftConstants& constants, const LightFit& fit, const ShadowTask& task)
    {
        const LightView& light = *task.light;
        const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
        const gpu::MapLookup& look = constants.base.map;
        constants.linear = linearDepthOf(fit, light);
        constants.four = task.settings[kFour] != 0.0;
        constants.radius = discRadius(light);
        constants.bleeding = static_cast<float>(task.settings[kBleeding]);
        constants.momentBias = kMomentBias;
        constants.deviation = kDeviation;
        constants.depthRange = directional ? fit.farWs - fit.nearWs : fit.nearWs / constants.linear.scale;
        const float cube = look.side / fit.texelAtOne;
        const bool point = light.type == GN_LIGHT_TYPE_POINT;
        constants.texelsX = point ? cube : 1.0f / glm::length(glm::vec3(look.texelDx));
        constants.texelsY = point ? cube : 1.0f / glm::length(glm::vec3(look.texelDy));
    }

    DepthMapPipelines casters_;
    SummedTables tables_;
    MapResolve resolve_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kMomentsSoft{
    .name = "moments_soft",
    .source = "Yang et al. 2010; Peters et al. 2016",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
            return depthMapMemory(resolution, mapLayers(type)) + SummedTables::memory(resolution, mapLayers(type));
        },
    .create = makeAlgorithm<MomentsSoft>,
    .typicalWrongPercent = 0.6f, // moments_soft.md
};

} // namespace gnomon
