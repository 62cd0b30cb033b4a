// area_adaptive from fewer points: what one hides ends in a ramp about a line, as wide as the gap to the next point's
// edge, and pixels on ramps show no step.
//
// Source:    Macedo 2018, chapter 6.
// Reads:     caster geometry, receiver depth and normals.    Writes: visibility.
// Strong at: smooth penumbrae from a tenth of area_light's maps.
// Weak at:   four round trips to the CPU; casters at several depths before one receiver.
#include "algorithms/entries.hpp"

#include "algorithms/area/quad_sampling.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/source_size.hpp"
#include "shaders/area_area_light_ramps_frag.h"
#include "shaders/area_quads_resolve_ramps_frag.h"
#include "shaders/area_quads_test_ramps_comp.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kLeast, kWindow, kFilter, kRamps, kReasons };

constexpr SettingSpec kSettings[] = {
    kQuadResolutionSetting,
    kQuadLeastSetting,
    {"window",
     "Pixels from one that is looked at for steps to the next; twice as many where squares are smallest. More of them "
     "take fewer points.",
     1, 16, 1},
    {"filter", "Texels per side, at most, of what is as wide as the gap between the edges of two points: odd.", 1,
     gpu::MAX_KERNEL_SIDE, 9},
    {"ramps", "Corners of a square, so many of which on ramps make a pixel show no step.", 1, 4, 2},
    kQuadReasonsSetting,
};

/// The outermost points of the finest lattice stand for half of what others do: their middle lies so far out.
constexpr float kInset = 1.0f - 0.5f / (kLattice - 1);

class AreaRevectorized final : public ShadowAlgorithm {
public:
    explicit AreaRevectorized(const AlgorithmServices& services)
        : quads_(services, {.words = "area_revectorized.words",
                            .look = "area_revectorized.look",
                            .test = "area_revectorized.test",
                            .resolve = "area_revectorized.resolve",
                            .format = VK_FORMAT_R32G32B32A32_UINT,
                            .lookCode = k_area_area_light_ramps_frag,
                            .testCode = k_area_quads_test_ramps_comp,
                            .resolveCode = k_area_quads_resolve_ramps_frag})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto window = static_cast<std::uint32_t>(task.settings[kWindow]);
        quads_.declare(passes, task,
                       {.resolution = static_cast<std::uint32_t>(task.settings[kResolution]),
                        .least = static_cast<std::uint32_t>(task.settings[kLeast]),
                        .window = {window, window, window, 2 * window},
                        .ramps = static_cast<std::uint32_t>(task.settings[kRamps]),
                        .filter = filterSide(task.settings[kFilter]),
                        .inset = kInset,
                        .reasons = task.settings[kReasons] != 0.0});
    }
    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }

private:
    QuadSampling quads_;
};

} // namespace

constinit const AlgorithmEntry kAreaRevectorized{
    .name = "area_revectorized",
    .source = "Macedo 2018, 6",
    .traits = kAreaTraits,
    .roundTrips = kQuadLevels,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType) {
            return quadMemory(static_cast<std::uint32_t>(settings[kResolution]), extent, 16);
        },
    .create = makeAlgorithm<AreaRevectorized>,
    .typicalWrongPercent = kAreaWrongPercent,
};

} // namespace gnomon
