// A light with a surface as the mean of depth maps from points of it, as many as the picture needs: squares of the
// source are divided where pixels would show a step.
//
// Source:    Schwarzler, Mattausch, Scherzer and Wimmer 2012; Macedo 2018, 6.1 (the rule of plateaus).
// Reads:     caster geometry, receiver depth and normals.    Writes: visibility.
// Strong at: narrow penumbrae: a handful of maps where area_light takes all.
// Weak at:   four round trips to the CPU; wide penumbrae that fill the picture take all 289 maps.
#include "algorithms/entries.hpp"

#include "algorithms/area/quad_sampling.hpp"
#include "algorithms/shared/source_size.hpp"
#include "shaders/area_area_light_bits_frag.h"
#include "shaders/area_quads_resolve_frag.h"
#include "shaders/area_quads_test_comp.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kLeast, kWindow, kReasons };

constexpr SettingSpec kSettings[] = {
    kQuadResolutionSetting,
    kQuadLeastSetting,
    {"window", "Pixels from one that is looked at for steps to the next; more of them take fewer points.", 1, 16, 2},
    kQuadReasonsSetting,
};

class AreaAdaptive final : public ShadowAlgorithm {
public:
    explicit AreaAdaptive(const AlgorithmServices& services)
        : quads_(services, {.words = "area_adaptive.words",
                            .look = "area_adaptive.bits",
                            .test = "area_adaptive.test",
                            .resolve = "area_adaptive.resolve",
                            .format = VK_FORMAT_R32_UINT,
                            .lookCode = k_area_area_light_bits_frag,
                            .testCode = k_area_quads_test_comp,
                            .resolveCode = k_area_quads_resolve_frag})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        QuadRule rule{.resolution = static_cast<std::uint32_t>(task.settings[kResolution]),
                      .least = static_cast<std::uint32_t>(task.settings[kLeast]),
                      .reasons = task.settings[kReasons] != 0.0};
        rule.window.fill(static_cast<std::uint32_t>(task.settings[kWindow]));
        quads_.declare(passes, task, rule);
    }
    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }

private:
    QuadSampling quads_;
};

} // namespace

constinit const AlgorithmEntry kAreaAdaptive{
    .name = "area_adaptive",
    .source = "Schwarzler et al. 2012; Macedo 2018, 6.1",
    .traits = kAreaTraits,
    .roundTrips = kQuadLevels,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType) {
            return quadMemory(static_cast<std::uint32_t>(settings[kResolution]), extent, 4);
        },
    .create = makeAlgorithm<AreaAdaptive>,
    .typicalWrongPercent = kAreaWrongPercent,
};

} // namespace gnomon
