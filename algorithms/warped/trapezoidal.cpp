// Trapezoidal shadow map: the trapezoid around what the view sees of a light's map becomes the whole map, 80 % of its
// length for what is near.
// Source:    T. Martin, T.-S. Tan, "Anti-aliasing and continuity with trapezoidal shadow maps", EGSR 2004.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: views across the light, close to what they look at.
// Weak at:   views along the light; cameras that move, since texels move with them.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/warped/warped_map.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kFocus, kFit, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map.", 64, 8192, 1024, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
    {"focus", "Part of the view's depth, by its logarithm, that gets 80 % of the map's length; 1: no warp.", 0.05, 1,
     0.8},
    {"fit", "1: the smallest rectangle around what is seen serves where it is finer.", 0, 1, 0},
    kContactSetting,
};

constexpr ViewMapNames kNames{"trapezoidal.depth",
                              "trapezoidal.statics",
                              "trapezoidal.stamp",
                              {"trapezoidal.casters", "trapezoidal.statics", "trapezoidal.copy_statics"}};

/// The part of a trapezoid's length up to which `share` of the view's depth lies, counted by its logarithm.
double focusOf(const SeenPart& part, double share)
{
    const double ratio = std::max(part.farthest / nearestReceiver(part), 1.0 + 1e-6);
    return (std::pow(ratio, share) - 1.0) / (ratio - 1.0);
}

/// Where the view looks along the light there is no near end of the map; up to there the warp fades with the sine of
/// the angle between the two.
Warp warpOf(const SeenPart& part, double focus)
{
    const double across = part.sine;
    return {.away = part.away, .strength = across * across * focusStrength(focusOf(part, focus))};
}

class Trapezoidal final : public ShadowAlgorithm {
public:
    explicit Trapezoidal(const AlgorithmServices& services) : map_(services, "trapezoidal.resolve", kNames) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const WarpSource source = map_.source(passes, task, resolution);
        map_.declare(passes, task, source, warpOf(source.part, task.settings[kFocus]),
                     {resolution, task.settings[kFilter], task.settings[kFit] >= 0.5, task.settings[kContact], 4.0});
    }

    const Map* lightMap() const override { return map_.lightMap(); }

private:
    WarpedMap map_;
};

} // namespace

constinit const AlgorithmEntry kTrapezoidal{
    .name = "trapezoidal",
    .source = "Martin and Tan 2004",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT |
              GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = lightMapMemory,
    .create = makeAlgorithm<Trapezoidal>,
    .typicalWrongPercent = 0.5f,
    .followsView = true,
};

} // namespace gnomon
