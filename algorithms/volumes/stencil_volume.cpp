#include "algorithms/volumes/stencil_volume.hpp"

#include "algorithms/volumes/gpu_silhouettes.hpp"
#include "algorithms/volumes/volume_count.hpp"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
    {"silhouettes", "0: found on the CPU; 1: in a compute shader", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail, kSilhouettes };

constexpr VolumeCountNames kNames{.volumes = {.zPass = {"stencil_volume.z_pass", "stencil_volume.z_pass_reversed"},
                                              .zFail = {"stencil_volume.z_fail", "stencil_volume.z_fail_reversed"}},
                                  .counted = "stencil_volume.counted",
                                  .withoutCasters = "stencil_volume.without_casters"};

class StencilVolume final : public ShadowAlgorithm {
public:
    explicit StencilVolume(const AlgorithmServices& services)
        : vk_(*services.vk), pipelines_(makeVolumeCountPipelines(services, kNames)),
          view_(makeViewStencilPipelines(services)), silhouettes_(makeGpuSilhouettes(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override
    {
        const char* reason = refusesVolumes(vk_, task);
        return reason || task.settings[kSilhouettes] == 0.0 ? reason : refusesGpuSides(vk_, task);
    }

private:
    const DeviceTable& vk_;
    VolumeCountPipelines pipelines_;
    ViewStencilPipelines view_;
    GpuSilhouettes silhouettes_;
};

void StencilVolume::declare(PassBuilder& passes, const ShadowTask& task)
{
    const ViewStencil stencil = declareViewStencil(passes, view_, task);
    const VolumePlan* volumes =
        planVolumes(passes, task, stencil, task.settings[kBounded] != 0.0, task.settings[kZFail] != 0.0,
                    task.settings[kSilhouettes] != 0.0 ? &silhouettes_ : nullptr);
    declareCount(passes, task, "stencil_volume.count", stencil, *volumes, pipelines_);
}

VkDeviceSize memoryPerLight(std::span<const double>, VkExtent2D extent, GnLightType)
{
    return viewStencilMemory(extent);
}

std::unique_ptr<ShadowAlgorithm> create(const AlgorithmServices& services)
{
    return std::make_unique<StencilVolume>(services);
}

} // namespace

const AlgorithmEntry kStencilVolume{
    .name = "stencil_volume",
    .source = "Rautenbach 2008, 3.1; Heidmann 1991; Everitt and Kilgard 2002",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .missing = missingForStencil,
    .create = create,
    .typicalWrongPercent = 0.004f, // README.md, table of methods
};

} // namespace gnomon
