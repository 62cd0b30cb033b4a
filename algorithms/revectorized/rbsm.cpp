// A depth map whose shadow edges are followed along their stairs of texels and replaced by lines.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 3 and
//            4.1.1.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: long, straight edges in coarse maps; nothing is stored beside the map.
// Weak at:   what is thinner than a texel; round casters of few texels, whose corners are cut.
#include "algorithms/entries.hpp"

#include "algorithms/revectorized/line_map.hpp"
#include "algorithms/shared/contact.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kMode, kLongest, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"mode",
     "0 conservative: the shadow grows to lines through its corners. 1: lines through the middles of its stairs. 2: a "
     "ramp of two texels about the same lines.",
     0, 2, 1},
    kLongestSetting,
    kContactSetting,
};

class Rbsm final : public ShadowAlgorithm {
public:
    explicit Rbsm(const AlgorithmServices& services) : lines_(services, "rbsm.resolve"), contact_(services) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        map_ = lines_.declare(passes, task, static_cast<std::uint32_t>(task.settings[kResolution]),
                              {.mode = static_cast<std::uint32_t>(task.settings[kMode]),
                               .longest = static_cast<std::uint32_t>(task.settings[kLongest])});
        contact_.declare(passes, task, task.settings[kContact]);
    }

    const Map* lightMap() const override { return &map_; }

private:
    LineMap lines_;
    ContactShadows contact_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kRbsm{
    .name = "rbsm",
    .source = "Macedo 2018, 3 and 4.1.1",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = lightMapMemory,
    .create = makeAlgorithm<Rbsm>,
    .typicalWrongPercent = 0.37f, // rbsm.md
};

} // namespace gnomon
