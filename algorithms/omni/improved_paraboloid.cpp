// One paraboloid around a point light outside the view, aimed at what is seen and cut to it; two halves where the light
// is inside.
// Source:    Navratil 2015, 4.1.1 to 4.1.3.
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: lights beside or behind the view: one pass, and texels spent where the view looks.
// Weak at:   moving cameras: each view has its own map, which follows it. Coarse casters, as dual_paraboloid.
#include "algorithms/entries.hpp"

#include <cmath>

#include <glm/trigonometric.hpp>

#include "algorithms/omni/paraboloid_maps.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kCulling, kWidest };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, and of each of the two halves where one does not serve.", 64, 4096,
     1024, true},
    kParaboloidFilter,
    kCullingSetting,
    {"widest_cone", "Half angle, degrees, of the widest cone that one paraboloid is cut to; 0: two halves always.", 0,
     85, 80},
    kContactSetting,
};

constexpr ParaboloidNames kNames{
    .resolve = "improved_paraboloid.resolve",
    .depth = "improved_paraboloid.depth",
    .statics = "improved_paraboloid.statics",
    .stamp = "improved_paraboloid.stamp",
    .parts = {{"improved_paraboloid.casters.lower", "improved_paraboloid.statics.lower",
               "improved_paraboloid.copy_statics.lower"},
              {"improved_paraboloid.casters.upper", "improved_paraboloid.statics.upper",
               "improved_paraboloid.copy_statics.upper"}},
};

class ImprovedParaboloid final : public ParaboloidMaps {
public:
    explicit ImprovedParaboloid(const AlgorithmServices& services) : ParaboloidMaps(services, kNames) {}

private:
    ParaboloidSet partsOf(const ShadowTask& task, std::uint32_t resolution, float reach,
                          MapCulling culling) const override
    {
        const LightView& light = *task.light;
        const Cone cone = coneOf(frustumOf(*task.view, light), light.position(), light.constants.range);
        const bool nothing = cone.cosine == 1.0f;
        const double widest = glm::radians(task.settings[kWidest]);
        const bool one = !nothing && widest > 0.0 && cone.cosine >= static_cast<float>(std::cos(widest));
        return one ? cutToCone(task, cone, resolution, reach) : lowerAndUpper(task, resolution, reach, culling);
    }
};

} // namespace

constinit const AlgorithmEntry kImprovedParaboloid{
    .name = "improved_paraboloid",
    .source = "Navratil 2015, 4.1.1 to 4.1.3",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .settings = kSettings,
    .memoryPerLight = ParaboloidMaps::memory,
    .create = makeAlgorithm<ImprovedParaboloid>,
    .typicalWrongPercent = 0.64f, // dual_paraboloid's, which it is where lights are in view
    .followsView = true,
};

} // namespace gnomon
