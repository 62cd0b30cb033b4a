// Percentage-closer filtering of a depth map whose edges are lines: penumbrae of a fixed width, without the stairs and
// steps that a map's texels make of them.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 4.1.2.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: even ramps from coarse maps.
// Weak at:   cost; what is thinner than a texel.
#include "algorithms/entries.hpp"

#include "algorithms/revectorized/line_map.hpp"
#include "algorithms/shared/contact.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kLongest, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"filter", "Texels per side of the box, odd: as many taps.", 1, gpu::MAX_LINE_TAPS, 7},
    kLongestSetting,
    kContactSetting,
};

class Rpcf final : public ShadowAlgorithm {
public:
    explicit Rpcf(const AlgorithmServices& services) : lines_(services, "rpcf.resolve"), contact_(services) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        map_ = lines_.declare(passes, task, static_cast<std::uint32_t>(task.settings[kResolution]),
                              {.mode = gpu::REVECTORIZE_KERNEL,
                               .longest = static_cast<std::uint32_t>(task.settings[kLongest]),
                               .filterSide = filterSide(task.settings[kFilter])});
        contact_.declare(passes, task, task.settings[kContact]);
    }

    const Map* lightMap() const override { return &map_; }

private:
    LineMap lines_;
    ContactShadows contact_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kRpcf{
    .name = "rpcf",
    .source = "Macedo 2018, 4.1.2",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = lightMapMemory,
    .create = makeAlgorithm<Rpcf>,
    .typicalWrongPercent = 1.2f, // rpcf.md
};

} // namespace gnomon
