// Two paraboloid maps around a point light: the lower and the upper half space, each drawn in one pass.
// Source:    S. Brabec, T. Annen, H.-P. Seidel, "Shadow mapping for hemispherical and omnidirectional light sources",
//            CGI 2002; Navratil 2015, 3.3.2 and 3.3.3 (leaving a half out by its cutting plane).
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: point lights over large views: two passes and a third of a cube map's memory.
// Weak at:   coarse casters near the light, which are cut on the CPU whenever they or the light move.
#include "algorithms/entries.hpp"

#include "algorithms/omni/culling.hpp"
#include "algorithms/omni/paraboloid_maps.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kCulling, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the two halves.", 64, 4096, 1024, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
    kCullingSetting,
    kContactSetting,
};

constexpr ParaboloidNames kNames{
    .resolve = "dual_paraboloid.resolve",
    .depth = "dual_paraboloid.depth",
    .statics = "dual_paraboloid.statics",
    .stamp = "dual_paraboloid.stamp",
    .parts = {{"dual_paraboloid.casters.lower", "dual_paraboloid.statics.lower", "dual_paraboloid.copy_statics.lower"},
              {"dual_paraboloid.casters.upper", "dual_paraboloid.statics.upper", "dual_paraboloid.copy_statics.upper"}},
};

class DualParaboloid final : public ShadowAlgorithm {
public:
    explicit DualParaboloid(const AlgorithmServices& services) : maps_(services, kNames) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const MapCulling culling = mapCulling(task.settings[kCulling]);
        const float reach = casterReach(*task.light, sceneBounds(*task.casters));
        maps_.declare(passes, task, lowerAndUpper(task, resolution, reach, culling), reach,
                      {.resolution = resolution,
                       .filterSide = filterSide(task.settings[kFilter]),
                       .culling = culling,
                       .contact = task.settings[kContact]});
    }

    const Map* lightMap() const override { return &maps_.map(); }

private:
    ParaboloidMaps maps_;
};

} // namespace

constinit const AlgorithmEntry kDualParaboloid{
    .name = "dual_paraboloid",
    .source = "Brabec, Annen and Seidel 2002; Navratil 2015, 3.3.2",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double> settings, VkExtent2D,
                         GnLightType) { return paraboloidMemory(settings[kResolution]); },
    .create = makeAlgorithm<DualParaboloid>,
    .typicalWrongPercent = 0.64f, // docs/benchmarks-2026-11.md
};

} // namespace gnomon
