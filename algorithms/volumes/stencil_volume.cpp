// Stencil shadow volumes: silhouettes from CPU or device, counted in the stencil of a copy of the host's depth.
// Source:    Rautenbach 2008, 3.1; Crow 1977; Heidmann 1991; Everitt and Kilgard 2002. Signed multiplicities:
//            Bergeron 1986; Kim, Kim and Turk 2008.
// Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes: visibility.
// Strong at: pixel-exact edges for all kinds of light, open, holed and flipped meshes included.
// Weak at:   fill where long shadows cross the whole view; casters it sees as triangles only (no alpha test).
#include "algorithms/entries.hpp"

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/volumes/mesh_volumes.hpp"
#include "algorithms/volumes/volume_count.hpp"
#include "algorithms/volumes/volume_cull.hpp"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
    {"silhouettes", "0: found on the CPU; 1: in a compute shader", 0, 1, 0},
    {"extents", "1: volumes are held against the extents of the depth image; 0: against the view frustum only", 0, 1,
     0},
};
enum Setting : std::size_t { kBounded, kZFail, kSilhouettes, kExtents };

constexpr VolumeCountNames kNames{.volumes = {.zPass = "stencil_volume.z_pass", .zFail = "stencil_volume.z_fail"},
                                  .resolve = "stencil_volume.resolve"};

class StencilVolume final : public ShadowAlgorithm {
public:
    explicit StencilVolume(const AlgorithmServices& services)
        : vk_(*services.vk), pipelines_(makeVolumeCountPipelines(services, kNames)),
          view_(makeViewStencilPipelines(services)), meshes_(makeMeshVolumePipelines(services)),
          cull_(makeVolumeCullPipelines(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override
    {
        const char* reason = refusesVolumes(vk_, task);
        return reason ? reason : refusesMeshVolumes(vk_, task, task.settings[kSilhouettes] != 0.0);
    }

private:
    const DeviceTable& vk_;
    VolumeCountPipelines pipelines_;
    ViewStencilPipelines view_;
    MeshVolumePipelines meshes_;
    VolumeCullPipelines cull_;
};

std::uint64_t stampOf(const LightView& light, const VolumeList& list)
{
    Stamp stamp;
    stamp.add(light.revision);
    for (const VolumePiece& piece : list.pieces)
        stamp.add(*piece.source.caster);
    return stamp.value();
}

void StencilVolume::declare(PassBuilder& passes, const ShadowTask& task)
{
    const ViewStencil stencil = declareViewStencil(passes, view_, task);
    const bool zFailForAll = task.settings[kZFail] != 0.0;
    VolumePlan* volumes = planVolumes(passes, task, stencil, task.settings[kBounded] != 0.0, zFailForAll,
                                      task.settings[kSilhouettes] != 0.0 ? &meshes_ : nullptr);
    addMeshVolumes(passes, task, meshes_, zFailForAll, *volumes);
    if (task.settings[kExtents] != 0.0 && canReadLists(vk_, task)) {
        CulledList lists[2];
        for (const std::uint32_t i : {0u, 1u})
            lists[i] = {.index = i, .stamp = stampOf(*task.light, volumes->lists[i]), .variant = i, .occluders = {}};
        declareCull(passes, cull_, task, stencil, lists, *volumes);
    }
    declareCount(passes, task, "stencil_volume.count", stencil, *volumes, pipelines_);
}

VkDeviceSize memoryPerLight(std::span<const double> settings, VkExtent2D extent, GnLightType)
{
    return viewStencilMemory(extent) + (settings[kExtents] != 0.0 ? cullMemory(extent) : 0);
}

} // namespace

const AlgorithmEntry kStencilVolume{
    .name = "stencil_volume",
    .source = "Rautenbach 2008, 3.1; Heidmann 1991; Everitt and Kilgard 2002",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT |
              GN_TRAIT_GPU_POSITIONS_BIT,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .missing = missingForStencil,
    .create = makeAlgorithm<StencilVolume>,
    .typicalWrongPercent = 0.004f, // an upper bound of docs/benchmarks-2026-11.md
};

} // namespace gnomon
