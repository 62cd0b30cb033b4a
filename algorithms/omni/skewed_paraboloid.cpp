// Two paraboloid maps around a point light whose dense rims meet where the view looks.
// Source:    Navratil 2015, 4.1.4.
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: lights near the eye: shadows before the camera get three times the texels of dual_paraboloid.
// Weak at:   what lies behind the light gets fewer; the maps follow the view; coarse casters, as dual_paraboloid.
#include "algorithms/entries.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "algorithms/omni/paraboloid_maps.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kCulling, kSkew };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the two halves.", 64, 4096, 1024, true},
    kParaboloidFilter,
    kCullingSetting,
    {"skew", "Degrees by which the paraboloids lean away from where the view looks; 0: two plain halves.", 0, 45, 30},
    kContactSetting,
};

constexpr ParaboloidNames kNames{
    .resolve = "skewed_paraboloid.resolve",
    .depth = "skewed_paraboloid.depth",
    .statics = "skewed_paraboloid.statics",
    .stamp = "skewed_paraboloid.stamp",
    .parts = {{"skewed_paraboloid.casters.first", "skewed_paraboloid.statics.first",
               "skewed_paraboloid.copy_statics.first"},
              {"skewed_paraboloid.casters.second", "skewed_paraboloid.statics.second",
               "skewed_paraboloid.copy_statics.second"}},
};

class SkewedParaboloid final : public ParaboloidMaps {
public:
    explicit SkewedParaboloid(const AlgorithmServices& services) : ParaboloidMaps(services, kNames) {}

private:
    ParaboloidSet partsOf(const ShadowTask& task, std::uint32_t resolution, float reach,
                          MapCulling culling) const override
    {
        const glm::vec3 dense = beforeTheEye(*task.view, task.light->position());
        return skewedHalves(task, beside(dense), dense, static_cast<float>(glm::radians(task.settings[kSkew])),
                            resolution, reach, culling);
    }
};

} // namespace

constinit const AlgorithmEntry kSkewedParaboloid{
    .name = "skewed_paraboloid",
    .source = "Navratil 2015, 4.1.4",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .settings = kSettings,
    .memoryPerLight = ParaboloidMaps::memory,
    .create = makeAlgorithm<SkewedParaboloid>,
    .typicalWrongPercent = 0.58f, // as gnomon bench prints it for colonnade, skewed_paraboloid.md
    .followsView = true,
};

} // namespace gnomon
