// A directional light's maps of slices of the view, fine near the eye, before one of all that casts.
// Source:    F. Zhang, H. Sun, L. Xu and L. Lun, "Parallel-split shadow maps for large-scale virtual environments",
//            2006.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: wide scenes; near shadows keep their quality however far the casters reach.
// Weak at:   several maps to draw, those of slices again when the camera has moved on; one set per view.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <iterator>

#include "algorithms/maps/cascade_fit.hpp"
#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/maps/cascades.h"
#include "shaders/maps_cascades_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kCount, kBlend, kFilter, kFade, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each map.", 64, 8192, 1024, true},
    {"cascades", "Maps, the one of all casters included.", 2, gpu::MAX_CASCADES, 4},
    {"blend", "Where slices end: 0 evenly, 1 each by the same factor farther than the one before.", 0, 1, 1},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
    {"fade", "Share of a map's half side before its edge over which filtered maps fade into the next.", 0, 0.5, 0.25},
    kContactSetting,
};

/// Texels that filters reach beside a receiver: half of 7 and the fraction.
constexpr float kBorderTexels = 4.0f;

constexpr LayerNames kNames[gpu::MAX_CASCADES] = {
    {"cascades.casters.0", "cascades.statics.0", "cascades.copy_statics.0"},
    {"cascades.casters.1", "cascades.statics.1", "cascades.copy_statics.1"},
    {"cascades.casters.2", "cascades.statics.2", "cascades.copy_statics.2"},
    {"cascades.casters.3", "cascades.statics.3", "cascades.copy_statics.3"},
    {"cascades.casters.4", "cascades.statics.4", "cascades.copy_statics.4"},
    {"cascades.casters.5", "cascades.statics.5", "cascades.copy_statics.5"},
};

class Cascades final : public ShadowAlgorithm {
public:
    explicit Cascades(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)),
          resolve_(services, {.name = "cascades.resolve", .fragment = k_maps_cascades_frag, .layers = true}),
          contact_(services)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const auto count = static_cast<std::uint32_t>(task.settings[kCount]);
        const std::span<const Cascade> cascades = fitCascades(
            task,
            {.count = count, .blend = task.settings[kBlend], .resolution = resolution, .borderTexels = kBorderTexels},
            passes.arena());
        const ImageId image = declareMaps(passes, task, cascades, resolution, count);

        gpu::CascadesConstants constants{};
        constants.base = mapConstants(task, resolution, filterSide(task.settings[kFilter]));
        addProjection(constants.base, cascades.front().fit, task);
        for (std::size_t i = 0; i < cascades.size(); ++i)
            constants.parts[i] = cascadePart(cascades.front(), cascades[i], resolution);
        constants.count = static_cast<std::uint32_t>(cascades.size());
        constants.lastLayer = static_cast<float>(cascades.back().layer);
        constants.border = kBorderTexels;
        constants.base.map.slope = static_cast<float>(0.5 * task.settings[kFade] * resolution);
        resolve_.declare(passes, task, image, constants, {.filtered = constants.base.map.filterSide > 1.0f});
        contact_.declare(passes, task, task.settings[kContact]);

        gpu::ShadowSample& sample = map_.sample = sampleOf(constants.base.map, gpu::SAMPLE_PARTS);
        std::copy(std::begin(constants.parts), std::end(constants.parts), sample.parts);
        sample.count = constants.count;
        sample.lastLayer = constants.lastLayer;
        sample.border = constants.border;
    }

    const Map* lightMap() const override { return &map_; }

private:
    ImageId declareMaps(PassBuilder& passes, const ShadowTask& task, std::span<const Cascade> cascades,
                        std::uint32_t resolution, std::uint32_t count)
    {
        KeptMap map(passes, {.name = "cascades.depth",
                             .staticsName = "cascades.statics",
                             .stampName = "cascades.stamp",
                             .format = kMapFormat,
                             .resolution = resolution,
                             .layers = count,
                             .scope = Scope::task});
        map_ = {.image = map.image(), .clipFromWorld = {}, .validLayers = 0, .sample = {}};
        FrameArena& arena = passes.arena();
        for (const Cascade& cascade : cascades) {
            const LightFit& fit = cascade.fit;
            const std::uint64_t projection = Stamp().add(fit.clipFromWorld).value();
            const LayerContent content = layerContent(*task.light, castersIn(task.casters->statics, fit.volume, arena),
                                                      castersIn(task.casters->dynamics, fit.volume, arena), projection);
            map.update(cascade.layer, kNames[cascade.layer], content,
                       DepthCasters(casters_, fit, task, resolution, arena));
            map_.clipFromWorld[cascade.layer] = fit.clipFromWorld;
            map_.validLayers |= 1u << cascade.layer;
        }
        return map.image();
    }

    DepthMapPipelines casters_;
    MapResolve resolve_;
    ContactShadows contact_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kCascades{
    .name = "cascades",
    .source = "Zhang, Sun, Xu and Lun 2006",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]),
                                  static_cast<std::uint32_t>(settings[kCount]));
        },
    .create = makeAlgorithm<Cascades>,
    .typicalWrongPercent = 0.29f, // cascades.md
    .followsView = true,
};

} // namespace gnomon
