#include "algorithms/volumes/volume_count.hpp"

#include <cmath>

#include "shaders/volumes_resolve_frag.h"
#include "shaders/volumes_resolve_vert.h"

namespace gnomon {

namespace {

/// What the raster pass draws; in the frame's arena.
struct DrawPlan {
    const VolumePlan* volumes = nullptr;
    ImageId depth, normals;
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

// --- recording ---

void recordVolumes(PassContext& gpu, const DrawPlan& plan, const VolumeCountPipelines& pipelines)
{
    const VkRect2D& pixels = plan.volumes->pixels;
    if (pixels.extent.width == 0) return; // the light reaches no pixel: 1 everywhere, as cleared
    gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
    drawVolumes(gpu, *plan.volumes, pipelines.volumes);

    const Bound resolve = gpu.constants(0, volumeResolve(*plan.volumes->view, *plan.volumes->light));
    const Bound depth = gpu.sampled(1, plan.depth, SamplerKind::nearest, 0);
    // Without normals the shader does not read them; something must be bound.
    const Bound normals = gpu.sampled(2, plan.normals ? plan.normals : plan.depth, SamplerKind::nearest, 0);
    for (const PipelineId pipeline : {pipelines.counted, pipelines.withoutCasters}) {
        gpu.bind(pipeline, {resolve, depth, normals});
        gpu.drawFullscreen();
    }
}

} // namespace

gpu::VolumeResolve volumeResolve(const CameraView& view, const LightView& light)
{
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

VolumeCountPipelines makeVolumeCountPipelines(const AlgorithmServices& services, const VolumeCountNames& names,
                                              VolumeShape shape)
{
    return {.volumes = makeVolumePipelines(services, names.volumes, {}, shape),
            .counted = makeResolvePipeline(services, names.counted, true),
            .withoutCasters = makeResolvePipeline(services, names.withoutCasters, false)};
}

void declareCount(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                  const VolumePlan& volumes, const VolumeCountPipelines& pipelines)
{
    DrawPlan* plan = passes.arena().make<DrawPlan>();
    plan->volumes = &volumes;
    plan->depth = task.depth;
    plan->normals = task.normals;

    const VkRect2D& area = task.view->area;
    PassRef pass = passes.raster(name);
    pass.area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
        .writes(task.visibility, {.layer = task.layer, .clear = true, .value = {.color = {{1.0f, 0.0f, 0.0f, 0.0f}}}})
        .depthTest(stencil.image)
        .stencilWrite(stencil.image, {.clear = true})
        .samples(task.depth);
    usesVolumes(pass, volumes);
    if (task.normals) pass.samples(task.normals);
    const VolumeCountPipelines* used = &pipelines;
    pass.record([plan, used](PassContext& gpu) { recordVolumes(gpu, *plan, *used); });
}

} // namespace gnomon
