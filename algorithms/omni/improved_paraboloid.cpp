// One paraboloid around a point light outside the view, aimed at what is seen and cut to it; two halves where the light
// is inside.
// Source:    Navratil 2015, 4.1.1 to 4.1.3.
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: lights beside or behind the view: one pass, and texels spent where the view looks.
// Weak at:   moving cameras: each view has its own map, which follows it. Coarse casters, as dual_paraboloid.
#include "algorithms/entries.hpp"

#include <cmath>

#include <glm/trigonometric.hpp>

#include "algorithms/omni/culling.hpp"
#include "algorithms/omni/paraboloid_maps.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kCulling, kWidest, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, and of each of the two halves where one does not serve.", 64, 4096,
     1024, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
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

class ImprovedParaboloid final : public ShadowAlgorithm {
public:
    explicit ImprovedParaboloid(const AlgorithmServices& services) : maps_(services, kNames) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const MapCulling culling = mapCulling(task.settings[kCulling]);
        const LightView& light = *task.light;
        const float reach = casterReach(light, sceneBounds(*task.casters));
        const Cone cone = coneOf(frustumOf(*task.view, light), light.position(), light.constants.range);
        const bool nothing = cone.cosine == 1.0f;
        const double widest = glm::radians(task.settings[kWidest]);
        const bool one = !nothing && widest > 0.0 && cone.cosine >= static_cast<float>(std::cos(widest));
        maps_.declare(passes, task,
                      one ? cutToCone(task, cone, resolution, reach) : lowerAndUpper(task, resolution, reach, culling),
                      reach,
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

constinit const AlgorithmEntry kImprovedParaboloid{
    .name = "improved_paraboloid",
    .source = "Navratil 2015, 4.1.1 to 4.1.3",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double> settings, VkExtent2D,
                         GnLightType) { return paraboloidMemory(settings[kResolution]); },
    .create = makeAlgorithm<ImprovedParaboloid>,
    .typicalWrongPercent = 0.64f, // dual_paraboloid's, which it is where lights are in view
    .followsView = true,
};

} // namespace gnomon
