// A light with a surface as the mean of many lights without: volumes are counted from each of n x n points of it.
//
// Source:    Brotman and Badler 1984, "Generating soft shadows with a depth buffer algorithm".
// Reads:     caster triangles with topology, receiver depth and normals.    Writes: visibility.
// Strong at: right penumbrae of any width, of several casters too, without texels; no work on the CPU for a point.
// Weak at:   price: every point draws all volumes, which fill the view; penumbrae have as many steps as points.
#include "algorithms/entries.hpp"

#include "algorithms/shared/source_points.hpp"
#include "algorithms/shared/source_size.hpp"
#include "algorithms/volumes/edge_volumes.hpp"
#include "algorithms/volumes/mesh_planes.hpp"
#include "algorithms/volumes/stencil_resolve.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/volumes/multi_volume.h"

#include "shaders/volumes_multi_volume_resolve_frag.h"
#include "shaders/volumes_multi_volume_sum_frag.h"
#include "shaders/volumes_resolve_vert.h"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"side", "Points of the light's surface: as many a row, in as many rows.", 2, 17, 4},
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kSide, kBounded, kZFail };

constexpr VolumePipelineNames kNames{
    .zPass = "multi_volume.z_pass", .zFail = "multi_volume.z_fail", .caps = "multi_volume.caps"};

constexpr VkFormat kSumFormat = VK_FORMAT_R16_SFLOAT; // every device blends it; whole numbers to 2048

constexpr BindingInfo kBindings[] = {constantsAt(0), sampledAt(1, VK_FORMAT_D32_SFLOAT),
                                     sampledAt(2, VK_FORMAT_R16G16B16A16_SFLOAT), sampledAt(3, kSumFormat)};

/// The draw that counts a point where the stencil is not 0, or where it is (multi_volume_sum.frag).
PipelineId makeSum(const AlgorithmServices& services, const char* name, bool turned)
{
    return services.pipelines->graphics({.name = name,
                                         .vertex = {.code = k_volumes_resolve_vert},
                                         .fragment = {k_volumes_multi_volume_sum_frag, 1, {turned ? 1u : 0u}},
                                         .bindings = std::span(kBindings).first(3),
                                         .stencil = stencilTest(turned ? VK_COMPARE_OP_EQUAL : VK_COMPARE_OP_NOT_EQUAL),
                                         .blendScale = true,
                                         .colorFormat = kSumFormat,
                                         .depthFormat = kStencilFormat});
}

PipelineId makeResolve(const AlgorithmServices& services)
{
    return services.pipelines->graphics({.name = "multi_volume.resolve",
                                         .vertex = {.code = k_volumes_resolve_vert},
                                         .fragment = {.code = k_volumes_multi_volume_resolve_frag},
                                         .bindings = kBindings,
                                         .colorFormat = VK_FORMAT_R8_UNORM});
}

class MultiVolumes final : public ShadowAlgorithm {
public:
    explicit MultiVolumes(const AlgorithmServices& services)
        : vk_(*services.vk),
          volumes_(makeVolumePipelines(services, kNames, {.color = kSumFormat}, VolumeShape::allEdges)),
          view_(makeViewStencilPipelines(services)), findPlanes_(makeFindPlanes(services)),
          counted_(makeSum(services, "multi_volume.counted", false)),
          turned_(makeSum(services, "multi_volume.turned", true)), resolve_(makeResolve(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override
    {
        const char* reason = refusesEdgeVolumes(vk_, task);
        return reason ? reason : refusesDisc(*task.light);
    }

private:
    void declarePoint(PassBuilder& passes, const ShadowTask& point, const ViewStencil& stencil, ImageId sums,
                      std::uint32_t i, const gpu::MultiVolume* constants) const;

    const DeviceTable& vk_;
    VolumePipelines volumes_;
    ViewStencilPipelines view_;
    PipelineId findPlanes_, counted_, turned_, resolve_;
};

/// What the passes read of the view.
void usesView(PassRef& pass, const ShadowTask& task)
{
    pass.area(drawnArea(*task.view)).samples(task.depth);
    if (task.normals) pass.samples(task.normals);
}

/// Counts the volumes of one point. @param point the task with its light
void MultiVolumes::declarePoint(PassBuilder& passes, const ShadowTask& point, const ViewStencil& stencil, ImageId sums,
                                std::uint32_t i, const gpu::MultiVolume* constants) const
{
    const VolumePlan* plan = planEdgeVolumes(passes, point, stencil, findPlanes_, point.settings[kBounded] != 0.0,
                                             point.settings[kZFail] != 0.0);
    PassRef pass = passes.raster("multi_volume.count", Scope::task, i);
    pass.writes(sums, {.clear = i == 0, .blend = true})
        .depthTest(stencil.image)
        .stencilWrite(stencil.image, {.clear = true});
    usesView(pass, point);
    usesVolumes(pass, *plan);
    pass.record([=, depth = point.depth, normals = point.normals, this](PassContext& gpu) {
        if (!gpu.clipTo(plan->pixels)) return;
        drawVolumes(gpu, *plan, volumes_);
        const auto sum = [&](PipelineId pipeline) {
            gpu.bind(pipeline,
                     {gpu.constants(0, *constants), gpu.sampled(1, depth), gpu.sampled(2, normals ? normals : depth)});
            gpu.drawFullscreen();
        };
        sum(counted_);
        if (normals) sum(turned_);
    });
}

void MultiVolumes::declare(PassBuilder& passes, const ShadowTask& task)
{
    FrameArena& arena = passes.arena();
    const ViewStencil stencil = declareViewStencil(passes, view_, task);
    const ImageId sums = passes.transient(
        ImageInfo{.name = "multi_volume.sums", .format = kSumFormat, .extent = passes.extent(task.depth)});
    const LightView& light = *task.light;
    const bool soft = light.constants.sourceRadius > 0.0f;
    const std::uint32_t side = soft ? static_cast<std::uint32_t>(task.settings[kSide]) : 1;
    auto* constants = arena.make(gpu::MultiVolume{.volumes = volumeResolve(*task.view, light), .pointEs = {}});
    for (std::uint32_t i = 0; i < side * side; ++i) {
        ShadowTask point = task;
        if (soft) point.light = arena.make(lightAt(light, spreadOver(light, i, side)));
        constants = arena.make(*constants);
        constants->pointEs =
            glm::vec4(light.type == GN_LIGHT_TYPE_DIRECTIONAL ? -point.light->direction()
                                                              : point.light->position() - task.view->eye,
                      1.0f / static_cast<float>(side * side));
        declarePoint(passes, point, stencil, sums, i, constants);
    }
    const VkRect2D pixels = lightPixels(light, *task.view);
    PassRef pass = passes.raster("multi_volume.resolve");
    pass.writes(task.visibility, visibilityIn(*task.view, task.layer, pixels)).samples(sums);
    usesView(pass, task);
    pass.record([=, depth = task.depth, normals = task.normals, pipeline = resolve_](PassContext& gpu) {
        if (!gpu.clipTo(pixels)) return;
        gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(1, depth),
                            gpu.sampled(2, normals ? normals : depth), gpu.sampled(3, sums)});
        gpu.drawFullscreen();
    });
}

} // namespace

const AlgorithmEntry kMultiVolume{
    .name = "multi_volume",
    .source = "Brotman and Badler 1984",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_FLAT_SOURCE_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT | GN_TRAIT_GPU_POSITIONS_BIT,
    .settings = kSettings,
    // Lists belong to meshes, not to lights.
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent,
                         GnLightType) { return viewStencilMemory(extent) + storedImageSize(extent, 2); },
    .missing = missingForStencil,
    .create = makeAlgorithm<MultiVolumes>,
    .typicalWrongPercent = 0.004f, // of lights without a surface: stencil_volume's
};

} // namespace gnomon
