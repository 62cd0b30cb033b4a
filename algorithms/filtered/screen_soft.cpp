// Soft shadows of lights with a radius from their depth map, filtered on the screen: the blockers around a receiver say
// how wide the penumbra is, and the hard shadow is blurred as widely on the receiver's plane.
// Source:    Z. Zheng, S. Saito, "Screen space anisotropic blurred soft shadows", SIGGRAPH 2011 posters;
//            M. MohammadBagher, J. Kautz, N. Holzschuch, C. Soler, "Screen-space percentage-closer soft shadows",
//            SIGGRAPH 2010 posters.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: wide penumbrae without grain, at a price that grows with their width and not with its square.
// Weak at:   shadows whose edge is not on the screen; several casters; edges as fine as texels are.
#include "algorithms/entries.hpp"

#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/screen_penumbra.hpp"
#include "shaders/filtered_nearest_cube_frag.h"
#include "shaders/filtered_nearest_frag.h"
#include "shaders/filtered_screen_soft_cube_frag.h"
#include "shaders/filtered_screen_soft_frag.h"

namespace gnomon {

namespace {

class ScreenSoft final : public ScreenPenumbra {
public:
    explicit ScreenSoft(const AlgorithmServices& services)
        : ScreenPenumbra(services, {.seen = "screen_soft.seen",
                                    .rows = "screen_soft.rows",
                                    .columns = "screen_soft.columns",
                                    .soft = {k_filtered_screen_soft_frag, k_filtered_screen_soft_cube_frag}}),
          casters_(makeDepthMapPipelines(services)), hard_(services, {.name = "screen_soft.hard",
                                                                      .fragment = k_filtered_nearest_frag,
                                                                      .cube = k_filtered_nearest_cube_frag,
                                                                      .filters = false})
    {
    }

private:
    Map declareHard(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[0]);
        gpu::MapConstants constants = mapConstants(task, resolution, 1);
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants);
        hard_.declare(passes, task, map.image, constants);
        return handedOut(map.image, map.fits, map.needed, constants);
    }

    DepthMapPipelines casters_;
    MapResolve hard_;
};

} // namespace

constinit const AlgorithmEntry kScreenSoft{
    .name = "screen_soft",
    .source = "MohammadBagher et al. 2010; Zheng and Saito 2011",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kScreenPenumbraSettings,
    .memoryPerLight = ScreenPenumbra::memory,
    .create = makeAlgorithm<ScreenSoft>,
    .typicalWrongPercent = 0.54f, // of lights without a radius: shadow_map's
};

} // namespace gnomon
