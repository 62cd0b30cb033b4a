// Shadow map of directional and spot lights, compared at the nearest texel or averaged over a box of texels (PCF).
// Source:    L. Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978; W. Reeves, D. Salesin, R. Cook,
//            "Rendering antialiased shadows with depth maps", SIGGRAPH 1987.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: many triangles, many lights; anything the host can draw casts.
// Weak at:   shadow edges are as fine as texels are.
#include "algorithms/entries.hpp"

#include "algorithms/maps/desired_view.hpp"
#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/maps_shadow_map_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kKernel, kFit, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map.", 64, 8192, 1024, true},
    kKernelSideSetting,
    kKernelSetting,
    {"fit",
     "0: the map covers all casters or the cone; 1: the smallest rectangle around what the view sees of that; 2: the "
     "receivers in view.",
     0, 2, 0},
    kContactSetting,
};

class ShadowMap final : public ShadowAlgorithm {
public:
    explicit ShadowMap(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)),
          resolve_(services, {.name = "shadow_map.resolve", .fragment = k_maps_shadow_map_frag}), desired_(services),
          contact_(services)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        cropped_ = task.settings[kFit] >= 1.5 && DesiredViewMap::serves(task);
        if (cropped_) {
            declareCropped(passes, task);
        } else {
            declareMap(passes, task);
            resolve_.declare(passes, task, map_.image, {task.view->constants, map_.sample.map});
        }
        contact_.declare(passes, task, task.settings[kContact]);
    }

    const Map* lightMap() const override { return cropped_ ? nullptr : &map_; } // only the GPU knows the crop

    const Map* declareMap(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const std::uint32_t side = filterSide(task.settings[kFilter]);
        const DepthMap map = task.settings[kFit] >= 0.5 && task.settings[kFit] < 1.5
                                 ? declareSeenMap(passes, casters_, task, resolution, kernelBorder(side))
                                 : declareDepthMap(passes, casters_, task, resolution, kernelBorder(side));
        const gpu::MapConstants constants = constantsOf(task, *map.fit, resolution, side);
        map_ = {.image = map.image,
                .clipFromWorld = {map.fit->clipFromWorld},
                .sample = sampleOf(constants.map, gpu::SAMPLE_MATRIX)};
        return &map_;
    }

private:
    static gpu::MapConstants constantsOf(const ShadowTask& task, const LightFit& fit, std::uint32_t resolution,
                                         std::uint32_t filterSide)
    {
        gpu::MapConstants constants = mapConstants(task, resolution, filterSide);
        constants.map.kernel = static_cast<float>(task.settings[kKernel]);
        addProjection(constants, fit, task);
        return constants;
    }

    void declareCropped(PassBuilder& passes, const ShadowTask& task) const
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const std::uint32_t side = filterSide(task.settings[kFilter]), border = kernelBorder(side);
        const LightFit& fit = *fitDepthMap(casters_.clamped, task, resolution, passes.arena(), border);
        desired_.declare(passes, task, fit, constantsOf(task, fit, resolution, side), border);
    }

    DepthMapPipelines casters_;
    MapResolve resolve_;
    DesiredViewMap desired_;
    ContactShadows contact_;
    Map map_;
    bool cropped_ = false;
};

} // namespace

constinit const AlgorithmEntry kShadowMap{
    .name = "shadow_map",
    .source = "Williams 1978; Reeves, Salesin and Cook 1987",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT |
              GN_TRAIT_FALLBACK_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = lightMapMemory,
    .create = makeAlgorithm<ShadowMap>,
    .typicalWrongPercent = 0.54f, // docs/benchmarks-2026-11.md
};

} // namespace gnomon
