#include "algorithms/volumes/stencil_volume.hpp"

#include <cmath>

#include "algorithms/volumes/view_stencil.hpp"
#include "algorithms/volumes/volume_draw.hpp"

#include "shaders/volumes/volume.h"
#include "shaders/volumes_resolve_frag.h"
#include "shaders/volumes_resolve_vert.h"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail };

constexpr VolumePipelineNames kVolumeNames{.zPass = {"stencil_volume.z_pass", "stencil_volume.z_pass_reversed"},
                                           .zFail = {"stencil_volume.z_fail", "stencil_volume.z_fail_reversed"}};

struct Pipelines {
    VolumePipelines volumes;
    PipelineId counted, withoutCasters; ///< Resolve: where the stencil is not 0, and everywhere.
    ViewStencilPipelines view;
};

/// What the raster pass draws; in the frame's arena.
struct DrawPlan {
    const VolumePlan* volumes = nullptr;
    ImageId depth, normals;
};

class StencilVolume final : public ShadowAlgorithm {
public:
    explicit StencilVolume(const AlgorithmServices& services);
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override;

private:
    const DeviceTable& vk_;
    Pipelines pipelines_;
};

// --- pipelines ---

constexpr BindingInfo kResolveBindings[] = {
    {.binding = 0, .kind = BindingKind::constants},
    {.binding = 1, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT},
    {.binding = 2, .kind = BindingKind::sampledImage, .format = VK_FORMAT_R16G16B16A16_SFLOAT}};

PipelineId makeResolvePipeline(const AlgorithmServices& services, const char* name, bool counted)
{
    GraphicsPipelineInfo info{
        .name = name,
        .vertex = {.code = k_volumes_resolve_vert},
        .fragment = {.code = k_volumes_resolve_frag, .specializationCount = 1, .specialization = {counted ? 1u : 0u}},
        .bindings = kResolveBindings};
    info.blendScale = !counted;
    if (counted) {
        const VkStencilOpState test{.failOp = VK_STENCIL_OP_KEEP,
                                    .passOp = VK_STENCIL_OP_KEEP,
                                    .depthFailOp = VK_STENCIL_OP_KEEP,
                                    .compareOp = VK_COMPARE_OP_NOT_EQUAL,
                                    .compareMask = 0xff,
                                    .writeMask = 0,
                                    .reference = 0};
        info.stencil = {.enable = true, .front = test, .back = test};
    }
    info.colorFormat = VK_FORMAT_R8_UNORM;
    info.depthFormat = kStencilFormat;
    return services.pipelines->graphics(info);
}

StencilVolume::StencilVolume(const AlgorithmServices& services) : vk_(*services.vk)
{
    pipelines_.volumes = makeVolumePipelines(services, kVolumeNames, {});
    pipelines_.counted = makeResolvePipeline(services, "stencil_volume.counted", true);
    pipelines_.withoutCasters = makeResolvePipeline(services, "stencil_volume.without_casters", false);
    pipelines_.view = makeViewStencilPipelines(services);
}

// --- recording ---

gpu::VolumeResolve resolveConstants(const DrawPlan& plan)
{
    const CameraView& view = *plan.volumes->view;
    const LightView& light = *plan.volumes->light;
    const float cosine = light.constants.directionWs.w, range = light.constants.range;
    gpu::VolumeResolve block{};
    block.view = view.constants;
    block.lightEs = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? glm::vec4(-light.direction(), 0.0f)
                                                            : glm::vec4(light.position() - view.eye, 1.0f);
    block.cone = glm::vec4(light.direction(), cosine * std::abs(cosine));
    const VkRect2D& area = view.area;
    block.area = {static_cast<float>(area.offset.x), static_cast<float>(area.offset.y),
                  static_cast<float>(area.extent.width), static_cast<float>(area.extent.height)};
    block.rangeSquared = range * range;
    return block;
}

void recordVolumes(PassContext& gpu, const DrawPlan& plan, const Pipelines& pipelines)
{
    const VkRect2D& pixels = plan.volumes->pixels;
    if (pixels.extent.width == 0) return; // the light reaches no pixel: 1 everywhere, as cleared
    gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
    drawVolumes(gpu, *plan.volumes, pipelines.volumes);

    const Bound resolve = gpu.constants(0, resolveConstants(plan));
    const Bound depth = gpu.sampled(1, plan.depth, SamplerKind::nearest, 0);
    // Without normals the shader does not read them; something must be bound.
    const Bound normals = gpu.sampled(2, plan.normals ? plan.normals : plan.depth, SamplerKind::nearest, 0);
    for (const PipelineId pipeline : {pipelines.counted, pipelines.withoutCasters}) {
        gpu.bind(pipeline, {resolve, depth, normals});
        gpu.drawFullscreen();
    }
}

void StencilVolume::declare(PassBuilder& passes, const ShadowTask& task)
{
    const ViewStencil stencil = declareViewStencil(passes, pipelines_.view, task);
    DrawPlan* plan = passes.arena().make<DrawPlan>();
    plan->volumes = planVolumes(passes, task, stencil, task.settings[kBounded] != 0.0, task.settings[kZFail] != 0.0);
    plan->depth = task.depth;
    plan->normals = task.normals;

    const VkRect2D& area = task.view->area;
    PassRef pass = passes.raster("stencil_volume.count");
    pass.area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
        .writes(task.visibility, {.layer = task.layer, .clear = true, .value = {.color = {{1.0f, 0.0f, 0.0f, 0.0f}}}})
        .depthTest(stencil.image)
        .stencilWrite(stencil.image, {.clear = true})
        .samples(task.depth);
    usesVolumes(pass, *plan->volumes);
    if (task.normals) pass.samples(task.normals);
    const Pipelines* pipelines = &pipelines_;
    pass.record([plan, pipelines](PassContext& gpu) { recordVolumes(gpu, *plan, *pipelines); });
}

const char* StencilVolume::refuses(const ShadowTask& task) const
{
    return refusesVolumes(vk_, task);
}

VkDeviceSize memoryPerLight(std::span<const double>, VkExtent2D extent)
{
    return viewStencilMemory(extent);
}

const char* missing(const DeviceTable&)
{
    return nullptr;
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
    .missing = missing,
    .create = create,
    .typicalWrongPercent = 0.004f, // README.md, table of methods
};

} // namespace gnomon
