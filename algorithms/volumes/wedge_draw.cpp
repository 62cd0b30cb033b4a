#include "algorithms/volumes/wedge_draw.hpp"

#include "algorithms/volumes/shadow_reach.hpp"
#include "runtime/scene/light_pixels.hpp"

#include "shaders/volumes/wedge.h"
#include "shaders/volumes_wedge_frag.h"
#include "shaders/volumes_wedge_vert.h"

namespace gnomon {

namespace {

constexpr BindingInfo kBindings[] = {{.binding = 0, .kind = BindingKind::constants},
                                     {.binding = 1, .kind = BindingKind::storageBuffer},
                                     {.binding = 2, .kind = BindingKind::storageBuffer},
                                     {.binding = 3, .kind = BindingKind::storageBuffer},
                                     {.binding = 4, .kind = BindingKind::constants},
                                     {.binding = 5, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT}};

PipelineId makePipeline(const AlgorithmServices& services, const char* name, bool reversed)
{
    GraphicsPipelineInfo info{.name = name,
                              .vertex = {.code = k_volumes_wedge_vert},
                              .fragment = {.code = k_volumes_wedge_frag},
                              .bindings = kBindings,
                              .pushBytes = sizeof(gpu::WedgePush)};
    // The far side of the hull, where it lies behind the receiver: every pixel once, wherever the eye is, and none
    // where the wedge is before the near plane. A receiver before the whole hull passes too, and finds that its share
    // is 0.
    info.cullMode = VK_CULL_MODE_FRONT_BIT;
    info.depthTest = true;
    info.depthCompare = reversed ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_GREATER;
    info.depthClamp = services.vk->enabled.depthClamp; // a far side behind a finite far plane is one
    info.blendScale = true;
    info.colorFormat = kCoverageFormat;
    info.depthFormat = kStencilFormat;
    return services.pipelines->graphics(info);
}

void collectDraws(WedgePlan& plan, const VolumeList& list)
{
    const float radius = plan.light->constants.sourceRadius;
    for (std::uint32_t piece = 0; piece < list.pieces.size();) {
        const VolumeDraw draw = drawAt(list, piece);
        if (shadowTouches(draw.caster->bounds, *plan.light, plan.view->frustum, radius)) append(plan.draws, draw);
    }
}

gpu::WedgeConstants wedgeConstants(const WedgePlan& plan)
{
    return {.view = plan.view->constants,
            .lightEs = glm::vec4(plan.light->position() - plan.view->eye, plan.light->constants.sourceRadius)};
}

/// The sides' own commands: six vertices an edge, here without indices, as often as a wedge has parts. Of a command for
/// an indexed draw the first four words are one without: count, instances, first, and a zero.
void drawParts(PassContext& gpu, const WedgePlan& plan, const VolumeDraw& draw)
{
    static_assert(offsetof(VkDrawIndexedIndirectCommand, indexCount) == offsetof(VkDrawIndirectCommand, vertexCount) &&
                  offsetof(VkDrawIndexedIndirectCommand, firstIndex) == offsetof(VkDrawIndirectCommand, firstVertex) &&
                  offsetof(VkDrawIndexedIndirectCommand, vertexOffset) ==
                      offsetof(VkDrawIndirectCommand, firstInstance));
    constexpr std::uint32_t stride = sizeof(VkDrawIndexedIndirectCommand);
    gpu::WedgePush push{};
    eyeRows(*draw.caster, *plan.view, push.caster.rows);
    push.caster.reach = glm::vec4(casterReach(draw.caster->bounds, *plan.light, plan.view->eye), 0.0f);
    for (push.part = 0; push.part < gpu::WEDGE_PARTS; ++push.part) {
        gpu.push(push);
        for (std::uint32_t i = 0; i < draw.commandCount; ++i)
            gpu.vk->vkCmdDrawIndirect(gpu.cmd, gpu.buffer(draw.commands),
                                      VkDeviceSize{stride} * (draw.firstCommand + i), 1, stride);
    }
}

void recordWedges(PassContext& gpu, const WedgePlan& plan, PipelineId pipeline)
{
    if (plan.pixels.extent.width == 0) return;
    gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &plan.pixels);
    const Bound constants = gpu.constants(0, volumeConstants(*plan.view, *plan.light, plan.bounded));
    const Bound wedges = gpu.constants(4, wedgeConstants(plan));
    const MeshView* mesh = nullptr;
    BufferId list;
    for (const VolumeDraw& draw : plan.draws) {
        if (draw.caster->mesh != mesh || draw.list.index != list.index) {
            mesh = draw.caster->mesh;
            list = draw.list;
            gpu.bind(pipeline, {constants, gpu.storage(1, mesh->vertexBuffer), gpu.storage(2, plan.receiverBounds),
                                gpu.storage(3, list), wedges, gpu.sampled(5, plan.depth, SamplerKind::nearest, 0)});
        }
        drawParts(gpu, plan, draw);
    }
}

} // namespace

WedgePipelines makeWedgePipelines(const AlgorithmServices& services)
{
    return {.wedges = {makePipeline(services, "penumbra_wedges.wedges", false),
                       makePipeline(services, "penumbra_wedges.wedges_reversed", true)}};
}

WedgePlan* planWedges(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                      std::span<const VolumeList, 2> sides, bool bounded)
{
    WedgePlan* plan = passes.arena().make<WedgePlan>();
    plan->view = task.view;
    plan->light = task.light;
    plan->receiverBounds = stencil.receiverBounds;
    plan->depth = task.depth;
    plan->bounded = bounded;
    plan->pixels = lightPixels(*task.light, *task.view);
    plan->draws = passes.arena().array<VolumeDraw>(task.casters->all.size()).first(0);
    for (std::size_t i = 0; i < 2; ++i) {
        collectDraws(*plan, sides[i]);
        plan->lists[i] = sides[i].buffer;
    }
    return plan;
}

ImageId declareWedges(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                      const WedgePlan& plan, const WedgePipelines& pipelines)
{
    const ImageId coverage = passes.transient(
        ImageInfo{.name = "penumbra_wedges.coverage", .format = kCoverageFormat, .extent = task.view->extent});
    const VkRect2D& area = task.view->area;
    PassRef pass = passes.raster(name);
    pass.area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
        .writes(coverage, {.clear = true, .value = {.color = {{0.0f, 0.0f, 0.0f, 0.0f}}}, .blend = true})
        .depthTest(stencil.image)
        .samples(task.depth)
        .reads(stencil.receiverBounds);
    for (const BufferId list : plan.lists)
        if (list) pass.reads(list).indirect(list);
    const WedgePlan* drawn = &plan;
    const PipelineId pipeline = pipelines.wedges[task.view->reversed() ? 1 : 0];
    pass.record([=](PassContext& gpu) { recordWedges(gpu, *drawn, pipeline); });
    return coverage;
}

} // namespace gnomon
