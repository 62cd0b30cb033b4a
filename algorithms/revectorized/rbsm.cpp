#include "algorithms/revectorized/rbsm.hpp"

#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/revectorized/rbsm.h"
#include "shaders/revectorized_rbsm_cube_frag.h"
#include "shaders/revectorized_rbsm_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kMode, kLongest };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"mode",
     "0 conservative: the shadow grows to lines through its corners. 1: lines through the middles of its stairs. 2: a "
     "ramp of two texels about the same lines.",
     0, 2, 1},
    // 16: the thesis's listings A.3 and B.2. Half-planes at any angle are wrong by 0.096, 0.089 and 0.084 texels per
    // texel of edge with 8, 16 and 32 (revectorized_test prints it).
    {"longest", "Texels that a stair is followed to each side.", 8, gpu::MAX_STAIR, 16},
};

class Rbsm final : public ShadowAlgorithm {
public:
    explicit Rbsm(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)),
          resolve_(services, {.name = "rbsm.resolve", .fragment = k_revectorized_rbsm_frag, .filters = false}),
          resolveCube_(
              services,
              {.name = "rbsm.resolve", .fragment = k_revectorized_rbsm_cube_frag, .layers = true, .filters = false})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        gpu::RbsmConstants constants{};
        constants.base = mapConstants(task, resolution, 1);
        constants.mode = static_cast<std::uint32_t>(task.settings[kMode]);
        constants.longest = static_cast<std::uint32_t>(task.settings[kLongest]);
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base);

        map_ = handedOut(map.image, map.fits, map.needed, constants.base);
        const MapResolve& resolve = task.light->type == GN_LIGHT_TYPE_POINT ? resolveCube_ : resolve_;
        resolve.declare(passes, task, map.image, constants, false);
    }

    const Map* lightMap() const override { return &map_; }

private:
    DepthMapPipelines casters_;
    Map map_;
    MapResolve resolve_, resolveCube_;
};

} // namespace

constinit const AlgorithmEntry kRbsm{
    .name = "rbsm",
    .source = "Macedo 2018, 3 and 4.1.1",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_FIXED_PENUMBRA_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), mapLayers(type));
        },
    .missing = nullptr,
    .create = makeAlgorithm<Rbsm>,
    .typicalWrongPercent = 0.37f, // rbsm.md
};

} // namespace gnomon
