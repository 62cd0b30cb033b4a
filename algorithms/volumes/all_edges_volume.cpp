// Stencil shadow volumes without a silhouette search: all edges of a mesh are drawn, from one list that depends on
// nothing but the mesh, and the vertex shader shrinks those that bound no volume to a point.
// Source:    I. Kolic, Z. Mihajlovic, L. Budin, "Stencil shadow volumes for complex and deformable objects", ICECS
// 2004;
//            Rautenbach 2008, 2.4.
// Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes: visibility.
// Strong at: many instances of few meshes, under lights that move: nothing is built, kept or uploaded for any of them.
// Weak at:   large meshes on slow vertex stages: every edge has its corners shaded in every frame and light.
#include "algorithms/entries.hpp"

#include "algorithms/volumes/edge_volumes.hpp"
#include "algorithms/volumes/mesh_planes.hpp"
#include "algorithms/volumes/volume_count.hpp"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail };

constexpr VolumeCountNames kNames{.volumes = {.zPass = "all_edges_volume.z_pass",
                                              .zFail = "all_edges_volume.z_fail",
                                              .caps = "all_edges_volume.caps"},
                                  .resolve = "all_edges_volume.resolve"};

class AllEdgesVolume final : public ShadowAlgorithm {
public:
    explicit AllEdgesVolume(const AlgorithmServices& services)
        : vk_(*services.vk), pipelines_(makeVolumeCountPipelines(services, kNames, VolumeShape::allEdges)),
          view_(makeViewStencilPipelines(services)), findPlanes_(makeFindPlanes(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const ViewStencil stencil = declareViewStencil(passes, view_, task);
        const VolumePlan* volumes = planEdgeVolumes(passes, task, stencil, findPlanes_, task.settings[kBounded] != 0.0,
                                                    task.settings[kZFail] != 0.0);
        declareCount(passes, task, "all_edges_volume.count", stencil, *volumes, pipelines_);
    }
    const char* refuses(const ShadowTask& task) const override { return refusesEdgeVolumes(vk_, task); }

private:
    const DeviceTable& vk_;
    VolumeCountPipelines pipelines_;
    ViewStencilPipelines view_;
    PipelineId findPlanes_;
};

} // namespace

const AlgorithmEntry kAllEdgesVolume{
    .name = "all_edges_volume",
    .source = "Kolic, Mihajlovic and Budin 2004; Rautenbach 2008, 2.4",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT |
              GN_TRAIT_GPU_POSITIONS_BIT,
    .settings = kSettings,
    // Lists belong to meshes, not to lights.
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent, GnLightType) { return viewStencilMemory(extent); },
    .missing = missingForStencil,
    .create = makeAlgorithm<AllEdgesVolume>,
    .typicalWrongPercent = 0.004f, // stencil_volume's picture
};

} // namespace gnomon
