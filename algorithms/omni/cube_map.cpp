// Six shadow maps around a point light, drawn face by face: only the faces a visible receiver can lie in, each with the
// casters in its pyramid.
// Source:    Navratil 2015, 3.3.1 and 3.3.3; G. King and W. Newhall, "Efficient omnidirectional shadow maps",
//            ShaderX3, 2005 (which faces and casters matter).
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: point lights near many triangles; even error all around, none at the seams.
// Weak at:   six times the memory of one map, and up to six times the clears.
#include "algorithms/entries.hpp"

#include "algorithms/omni/culling.hpp"
#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/cube_faces.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/omni_cube_map_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kKernel, kCulling, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the six faces.", 64, 4096, 1024, true},
    kKernelSideSetting,
    kKernelSetting,
    kCullingSetting,
    kContactSetting,
};

class CubeMapMethod final : public ShadowAlgorithm {
public:
    explicit CubeMapMethod(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)),
          resolve_(services, {.name = "cube_map.resolve", .fragment = k_omni_cube_map_frag, .layers = true}),
          contact_(services)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        declareMap(passes, task);
        resolve_.declare(passes, task, map_.image, {task.view->constants, map_.sample.map});
        contact_.declare(passes, task, task.settings[kContact]);
    }

    const Map* lightMap() const override { return &map_; }

    const Map* declareMap(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const std::uint32_t side = filterSide(task.settings[kFilter]);
        const CubeMap map =
            declareCubeMap(passes, casters_, task, resolution, kernelBorder(side), mapCulling(task.settings[kCulling]));
        gpu::MapConstants constants = mapConstants(task, resolution, side);
        constants.map.kernel = static_cast<float>(task.settings[kKernel]);
        addLightProjection(constants, std::span(map.faces, 6), task);
        map_ = handedOut(map.image, std::span(map.faces, 6), map.needed, constants);
        return &map_;
    }

private:
    DepthMapPipelines casters_;
    MapResolve resolve_;
    ContactShadows contact_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kCubeMap{
    .name = "cube_map",
    .source = "Navratil 2015, 3.3.1; King and Newhall 2005",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_FALLBACK_BIT |
              GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = lightMapMemory,
    .create = makeAlgorithm<CubeMapMethod>,
    .typicalWrongPercent = 0.35f, // docs/benchmarks-2026-11.md
};

} // namespace gnomon
