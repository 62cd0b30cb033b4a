// A revectorized shadow with penumbrae of lights with a radius: as wide at every edge as the depths beside it say, by
// distances on the screen.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 5.2.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: wide penumbrae: the price depends on the pixels, not on the width; no light in the umbra.
// Weak at:   edges that are not seen have no penumbra; shadows that are thinner than their penumbra.
#include "algorithms/entries.hpp"

#include "algorithms/revectorized/distance_penumbra.hpp"
#include "algorithms/shared/source_size.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kShow, kMean };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    kShowSetting,
    kMeanSetting,
};

class EdtSoft final : public ShadowAlgorithm {
public:
    explicit EdtSoft(const AlgorithmServices& services) : penumbra_(services) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        map_ = penumbra_.declare(passes, task,
                                 {.disc = discRadius(*task.light),
                                  .show = static_cast<std::uint32_t>(task.settings[kShow]),
                                  .mean = static_cast<float>(task.settings[kMean])});
    }

    const char* refuses(const ShadowTask& task) const override
    {
        const char* const why = penumbra_.refuses(task);
        return why ? why : refusesDisc(*task.light);
    }
    const Map* lightMap() const override { return &map_; }

private:
    DistancePenumbra penumbra_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kEdtSoft{
    .name = "edt_soft",
    .source = "Macedo 2018, 5.2; Meijster, Roerdink and Hesselink 2000",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return DistancePenumbra::memory(static_cast<std::uint32_t>(settings[kResolution]), extent, type,
                                            settings[kMean]);
        },
    .create = makeAlgorithm<EdtSoft>,
    .typicalWrongPercent = 0.4f, // of lights without a radius: rbsm's
};

} // namespace gnomon
