// A depth map answers where its four nearest texels agree; the pixels where they do not are traced on the CPU.
// Source:    S. Beister, M. Ernst, M. Stamminger, "A hybrid GPU-CPU renderer", VMV 2005; Morais 2015, 3.4.1 and 6.
// Reads:     casters' triangles, receiver depth and normals (also read back).     Writes: visibility.
// Strong at: shadow edges as sharp as ray-traced ones at the price of a map and a few percent of the rays.
// Weak at:   four texels can agree and be wrong: what is thinner than a texel may be missed.
#include "algorithms/entries.hpp"

#include <optional>

#include "algorithms/hybrid/map_classification.hpp"
#include "algorithms/hybrid/undecided_on_device.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/hybrid_pcf_hybrid_cube_frag.h"
#include "shaders/hybrid_pcf_hybrid_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kReasons, kClassify, kFit };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024, true},
    kReasonsSetting,
    kClassifySetting,
    kFitSetting,
};

constexpr UndecidedNames kNames = {.status = "pcf_hybrid.status",
                                   .readback = "pcf_hybrid.readback",
                                   .visibility = "pcf_hybrid.visibility",
                                   .trace = "pcf_hybrid.trace",
                                   .copy = "pcf_hybrid.copy",
                                   .list = "pcf_hybrid.list",
                                   .clear = "pcf_hybrid.clear_list"};

constexpr ClassificationNames kPassNames = {
    .visibility = "pcf_hybrid.visibility", .pass = "pcf_hybrid.classify_host", .copy = "pcf_hybrid.copy"};

class PcfHybrid final : public ShadowAlgorithm {
public:
    explicit PcfHybrid(const AlgorithmServices& services)
        : vk_(*services.vk), casters_(makeDepthMapPipelines(services)),
          classify_(services, {.name = "pcf_hybrid.classify",
                               .fragment = k_hybrid_pcf_hybrid_frag,
                               .cube = k_hybrid_pcf_hybrid_cube_frag,
                               .filters = false})
    {
        if (vk_.prefersRays) onDevice_.emplace(services, kNames);
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        // In the arena: a host pass that asks the map reads them after declare() has returned.
        gpu::HybridConstants& constants = *passes.arena().make<gpu::HybridConstants>();
        constants.base = mapConstants(task, resolution, 1);
        constants.reasons = task.settings[kReasons] != 0.0;
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base, kMapBorderTexels,
                                             mapFit(task.settings[kFit]));
        if (!task.rays && classifiesOnHost(task.settings[kClassify], vk_, task) &&
            passes.hasRoomFor(missingHostMap(passes, map, resolution))) {
            const HostMapCopy copy = declareHostMap(passes, map, resolution);
            declareMapClassification(passes, task, kPassNames, copy, constants.base, constants.reasons != 0);
            return;
        }
        classify_.declare(passes, task, map.image, constants, {});
        if (task.rays)
            onDevice_->declare(passes, task, constants.reasons != 0);
        else
            declareUndecided(passes, task, kNames, constants.reasons != 0 ? traceReasons : traceHard);
    }

private:
    const DeviceTable& vk_;
    DepthMapPipelines casters_;
    MapResolve classify_;
    std::optional<UndecidedOnDevice> onDevice_; ///< Where ShadowTask::rays may be given.
};

} // namespace

constinit const AlgorithmEntry kPcfHybrid{
    .name = "pcf_hybrid",
    .source = "Beister, Ernst and Stamminger 2005; Morais 2015, 3.4.1",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), mapLayers(type)) +
                   undecidedMemory(extent);
        },
    .create = makeAlgorithm<PcfHybrid>,
    .typicalWrongPercent = 0.032f, // docs/benchmarks-2026-11.md
    .memoryWithDeviceRays =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), mapLayers(type)) +
                   UndecidedOnDevice::memory(extent);
        },
};

} // namespace gnomon
