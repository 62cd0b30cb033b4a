#include "algorithms/hybrid/pcf_hybrid.hpp"

#include <array>

#include "algorithms/hybrid/map_classification.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/hybrid_pcf_hybrid_cube_frag.h"
#include "shaders/hybrid_pcf_hybrid_frag.h"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kReasons, kClassify };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024, true},
    kReasonsSetting,
    kClassifySetting,
};

PipelineId classifyPipeline(const AlgorithmServices& services, bool cube, bool normals)
{
    const std::array bindings = lookupBindings(cube);
    GraphicsPipelineInfo pipeline;
    pipeline.name = "pcf_hybrid.classify";
    pipeline.vertex.code = k_shared_map_resolve_vert;
    pipeline.fragment.code = cube ? std::span<const std::uint32_t>(k_hybrid_pcf_hybrid_cube_frag)
                                  : std::span<const std::uint32_t>(k_hybrid_pcf_hybrid_frag);
    pipeline.fragment.specializationCount = 1;
    pipeline.fragment.specialization[0] = normals;
    pipeline.bindings = bindings;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    return services.pipelines->graphics(pipeline);
}

constexpr UndecidedNames kNames = {.status = "pcf_hybrid.status",
                                   .readback = "pcf_hybrid.readback",
                                   .visibility = "pcf_hybrid.visibility",
                                   .trace = "pcf_hybrid.trace",
                                   .copy = "pcf_hybrid.copy"};

constexpr ClassificationNames kPassNames = {
    .visibility = "pcf_hybrid.visibility", .pass = "pcf_hybrid.classify_host", .copy = "pcf_hybrid.copy"};

class PcfHybrid final : public ShadowAlgorithm {
public:
    explicit PcfHybrid(const AlgorithmServices& services) : vk_(*services.vk)
    {
        casters_ = makeDepthMapPipelines(services);
        for (const bool cube : {false, true}) {
            for (const bool normals : {false, true})
                classify_[cube][normals] = classifyPipeline(services, cube, normals);
        }
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        gpu::HybridConstants* constants = passes.arena().make<gpu::HybridConstants>();
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        constants->base = mapConstants(task, resolution, 1);
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants->base);
        constants->reasons = task.settings[kReasons] != 0.0;
        if (classifiesOnHost(task.settings[kClassify], vk_, task) &&
            passes.hasRoomFor(missingHostMap(passes, map, resolution))) {
            const HostMapCopy copy = declareHostMap(passes, map, resolution);
            declareMapClassification(passes, task, kPassNames, copy, constants->base, constants->reasons != 0);
            return;
        }
        declareClassify(passes, task, map.image, constants);
        declareUndecided(passes, task, kNames, constants->reasons != 0 ? traceReasons : traceHard);
    }

private:
    void declareClassify(PassBuilder& passes, const ShadowTask& task, ImageId map,
                         const gpu::HybridConstants* constants) const
    {
        const LookupImages look(task, map);
        const PipelineId pipeline = classify_[task.light->type == GN_LIGHT_TYPE_POINT][look.hasNormals];
        LookupPass(passes, task, "pcf_hybrid.classify", look).record([=](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                                gpu.sampled(4, look.map, SamplerKind::nearestBorderFar)});
        });
    }

    const DeviceTable& vk_;
    DepthMapPipelines casters_;
    PipelineId classify_[2][2]; ///< [cube][has normals]
};

} // namespace

constinit const AlgorithmEntry kPcfHybrid{
    .name = "pcf_hybrid",
    .source = "Beister, Ernst and Stamminger 2005; Morais 2015, 3.4.1",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), mapLayers(type)) +
                   undecidedMemory(extent);
        },
    .missing = nullptr,
    .create = [](const AlgorithmServices& services) -> std::unique_ptr<ShadowAlgorithm> {
        return std::make_unique<PcfHybrid>(services);
    },
    .typicalWrongPercent = 0.032f, // docs/benchmarks-2026-11.md
};

} // namespace gnomon
