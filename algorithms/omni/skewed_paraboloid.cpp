// Two paraboloid maps around a point light whose dense rims meet where the view looks.
// Source:    Navratil 2015, 4.1.4.
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: lights near the eye: shadows before the camera get three times the texels of dual_paraboloid.
// Weak at:   what lies behind the light gets fewer; the maps follow the view; coarse casters, as dual_paraboloid.
#include "algorithms/entries.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "algorithms/omni/culling.hpp"
#include "algorithms/omni/paraboloid_maps.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kCulling, kSkew, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the two halves.", 64, 4096, 1024, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
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

class SkewedParaboloid final : public ShadowAlgorithm {
public:
    explicit SkewedParaboloid(const AlgorithmServices& services) : maps_(services, kNames) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const MapCulling culling = mapCulling(task.settings[kCulling]);
        const float reach = casterReach(*task.light, sceneBounds(*task.casters));
        const glm::vec3 dense = beforeTheEye(*task.view, task.light->position());
        maps_.declare(passes, task,
                      skewedHalves(task, beside(dense), dense, static_cast<float>(glm::radians(task.settings[kSkew])),
                                   resolution, reach, culling),
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

constinit const AlgorithmEntry kSkewedParaboloid{
    .name = "skewed_paraboloid",
    .source = "Navratil 2015, 4.1.4",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double> settings, VkExtent2D,
                         GnLightType) { return paraboloidMemory(settings[kResolution]); },
    .create = makeAlgorithm<SkewedParaboloid>,
    .typicalWrongPercent = 0.58f, // as gnomon bench prints it for colonnade, skewed_paraboloid.md
    .followsView = true,
};

} // namespace gnomon
