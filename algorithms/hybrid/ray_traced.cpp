#include "algorithms/hybrid/ray_traced.hpp"

#include "algorithms/hybrid/traced_pixels.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/host_visibility.hpp"

namespace gnomon {

namespace {

enum Setting { kReasons };

constexpr SettingSpec kSettings[] = {kReasonsSetting};

class RayTraced final : public ShadowAlgorithm {
public:
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        constexpr TracedNames names{"ray_traced.visibility", "ray_traced.trace", "ray_traced.copy"};
        declareTracedPixels(passes, task, names, task.settings[kReasons] != 0.0);
    }
};

} // namespace

constinit const AlgorithmEntry kRayTraced{
    .name = "ray_traced",
    .source = "Appel 1968; Morais 2015, 2.3",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent,
                         GnLightType) { return hostVisibilityMemory(extent); },
    .missing = nullptr,
    .create = makeAlgorithm<RayTraced>,
};

} // namespace gnomon
