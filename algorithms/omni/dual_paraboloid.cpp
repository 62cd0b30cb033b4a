// Two paraboloid maps around a point light: the lower and the upper half space, each drawn in one pass.
// Source:    S. Brabec, T. Annen, H.-P. Seidel, "Shadow mapping for hemispherical and omnidirectional light sources",
//            CGI 2002; Navratil 2015, 3.3.2 and 3.3.3 (leaving a half out by its cutting plane).
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: point lights over large views: two passes and a third of a cube map's memory.
// Weak at:   coarse casters near the light, which are cut on the CPU whenever they or the light move.
#include "algorithms/entries.hpp"

#include "algorithms/omni/paraboloid_maps.hpp"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the two halves.", 64, 4096, 1024, true},
    kParaboloidFilter,
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

class DualParaboloid final : public ParaboloidMaps {
public:
    explicit DualParaboloid(const AlgorithmServices& services) : ParaboloidMaps(services, kNames) {}

private:
    ParaboloidSet partsOf(const ShadowTask& task, std::uint32_t resolution, float reach,
                          MapCulling culling) const override
    {
        return lowerAndUpper(task, resolution, reach, culling);
    }
};

} // namespace

constinit const AlgorithmEntry kDualParaboloid{
    .name = "dual_paraboloid",
    .source = "Brabec, Annen and Seidel 2002; Navratil 2015, 3.3.2",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .settings = kSettings,
    .memoryPerLight = ParaboloidMaps::memory,
    .create = makeAlgorithm<DualParaboloid>,
    .typicalWrongPercent = 0.64f, // docs/benchmarks-2026-11.md
};

} // namespace gnomon
