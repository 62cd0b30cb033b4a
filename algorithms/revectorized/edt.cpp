// A revectorized shadow whose edges are ramps of one width in the world, by distances on the screen.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 4.2.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: wide ramps: the price depends on the pixels, not on the width.
// Weak at:   edges that are not seen have no ramp; lights whose penumbrae grow with the distance (edt_soft).
#include "algorithms/entries.hpp"

#include "algorithms/revectorized/distance_penumbra.hpp"
#include "algorithms/shared/contact.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kPenumbra, kShow, kMean, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"penumbra", "Width of the ramp, metres; 0: none, the picture of rbsm.", 0, 100, 0.1},
    kShowSetting,
    kMeanSetting,
    kContactSetting,
};

class Edt final : public ShadowAlgorithm {
public:
    explicit Edt(const AlgorithmServices& services) : penumbra_(services), contact_(services) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        map_ = penumbra_.declare(passes, task,
                                 {.width = static_cast<float>(task.settings[kPenumbra]),
                                  .show = static_cast<std::uint32_t>(task.settings[kShow]),
                                  .mean = static_cast<float>(task.settings[kMean])});
        contact_.declare(passes, task, task.settings[kContact]);
    }

    const char* refuses(const ShadowTask& task) const override { return penumbra_.refuses(task); }
    const Map* lightMap() const override { return &map_; }

private:
    DistancePenumbra penumbra_;
    ContactShadows contact_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kEdt{
    .name = "edt",
    .source = "Macedo 2018, 4.2; Meijster, Roerdink and Hesselink 2000",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return DistancePenumbra::memory(static_cast<std::uint32_t>(settings[kResolution]), extent, type,
                                            settings[kMean]);
        },
    .create = makeAlgorithm<Edt>,
    .typicalWrongPercent = 0.4f, // edt.md
};

} // namespace gnomon
