#include "algorithms/revectorized/edt_soft.hpp"

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
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
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
