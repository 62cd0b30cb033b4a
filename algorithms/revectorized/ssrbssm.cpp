// Soft shadows of lights with a radius: the shadow that revectorized edges give is blurred on the screen, as widely as
// the blockers around a receiver ask for.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 5.4.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: narrow penumbrae in coarse maps; wide ones without grain.
// Weak at:   shadows whose edge is not on the screen; several casters.
#include "algorithms/entries.hpp"

#include "algorithms/revectorized/line_map.hpp"
#include "algorithms/shared/screen_penumbra.hpp"
#include "shaders/revectorized_ssrbssm_cube_frag.h"
#include "shaders/revectorized_ssrbssm_frag.h"

namespace gnomon {

namespace {

constexpr auto kLongest = static_cast<std::uint32_t>(kLongestSetting.standard);

class Ssrbssm final : public ScreenPenumbra {
public:
    explicit Ssrbssm(const AlgorithmServices& services)
        : ScreenPenumbra(services, {.seen = "ssrbssm.seen",
                                    .rows = "ssrbssm.rows",
                                    .columns = "ssrbssm.columns",
                                    .soft = {k_revectorized_ssrbssm_frag, k_revectorized_ssrbssm_cube_frag},
                                    .look = {gpu::REVECTORIZE_FILTERED, kLongest, 0, 0}}),
          hard_(services, "ssrbssm.hard")
    {
    }

private:
    Map declareHard(PassBuilder& passes, const ShadowTask& task) override
    {
        return hard_.declare(passes, task, static_cast<std::uint32_t>(task.settings[0]), {.longest = kLongest});
    }

    LineMap hard_;
};

} // namespace

constinit const AlgorithmEntry kSsrbssm{
    .name = "ssrbssm",
    .source = "Macedo 2018, 5.4",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kScreenPenumbraSettings,
    .memoryPerLight = ScreenPenumbra::memory,
    .create = makeAlgorithm<Ssrbssm>,
    .typicalWrongPercent = 0.37f, // of lights without a radius: rbsm's
};

} // namespace gnomon
