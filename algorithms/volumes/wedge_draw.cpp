#include "algorithms/volumes/wedge_draw.hpp"

#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/stencil_resolve.hpp"
#include "runtime/scene/light_pixels.hpp"

#include "shaders/volumes_wedge_frag.h"
#include "shaders/volumes_wedge_vert.h"

namespace gnomon {

namespace {

constexpr BindingInfo kBindings[] = {constantsAt(0), bufferAt(1),    bufferAt(2),
                                     bufferAt(3),    constantsAt(4), bufferAt(5)};

/// @param before the hull's near side where it lies before the receiver; else its far side where that lies behind.
/// Either meets every pixel of the penumbra once and leaves it to the shader to find out about the other side. The near
/// side lets go of what lies behind walls and under the ground, most of what wedges cover; the eye must not be inside.
PipelineId makePipeline(const AlgorithmServices& services, const char* name, bool reversed, bool before)
{
    return services.pipelines->graphics(
        {.name = name,
         .vertex = {.code = k_volumes_wedge_vert},
         .fragment = {.code = k_volumes_wedge_frag},
         .bindings = kBindings,
         .pushBytes = sizeof(gpu::WedgePush),
         .cullMode = before ? VkCullModeFlags{VK_CULL_MODE_BACK_BIT} : VkCullModeFlags{VK_CULL_MODE_FRONT_BIT},
         .depthTest = true,
         .depthCompare = reversed == before ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS,
         .depthClamp = !before && services.vk->enabled.depthClamp, // a far side behind a finite far plane is one
         .blendScale = true,
         .colorFormat = kCoverageFormat,
         .depthFormat = kStencilFormat});
}

/// Whether a wedge of a source with these bounds may touch the near rectangle.
bool mayHoldEye(const WedgePlan& plan, const Aabb& bounds)
{
    return plan.view->oblique ||
           shadowsNearRectangle(bounds, *plan.light, plan.view->nearCorners, plan.light->constants.sourceRadius);
}

void collectDraws(WedgePlan& plan, const VolumeList& list)
{
    const float radius = plan.light->constants.sourceRadius;
    forDraws(
        list, [&](const Aabb& box) { return shadowTouches(box, *plan.light, plan.view->frustum, radius); },
        [&](const VolumeDraw& draw) { append(mayHoldEye(plan, draw.bounds) ? plan.around : plan.before, draw); });
}

gpu::WedgeConstants wedgeConstants(const WedgePlan& plan)
{
    return {.view = plan.view->constants,
            .lightEs = glm::vec4(plan.light->position() - plan.view->eye, plan.light->constants.sourceRadius),
            .depthColumns = plan.depthColumns};
}

/// The sides' own commands: six vertices an edge, here without indices, as often as a wedge has parts. Of a command for
/// an indexed draw the first four words are one without: count, instances, first, and a zero.
void drawParts(PassContext& gpu, const WedgePlan& plan, const VolumeDraw& draw, bool before)
{
    static_assert(offsetof(VkDrawIndexedIndirectCommand, indexCount) == offsetof(VkDrawIndirectCommand, vertexCount) &&
                  offsetof(VkDrawIndexedIndirectCommand, firstIndex) == offsetof(VkDrawIndirectCommand, firstVertex) &&
                  offsetof(VkDrawIndexedIndirectCommand, vertexOffset) ==
                      offsetof(VkDrawIndirectCommand, firstInstance));
    constexpr std::uint32_t stride = sizeof(VkDrawIndexedIndirectCommand);
    gpu::WedgePush push{};
    eyeRows(*draw.source.caster, *plan.view, push.caster.rows);
    push.caster.reach = glm::vec4(casterReach(draw.bounds, *plan.light, plan.view->eye), 0.0f);
    push.before = before ? 1 : 0;
    push.mirrored = mirrors(*plan.view) ? 1 : 0;
    for (push.part = 0; push.part < gpu::WEDGE_PARTS; ++push.part) {
        gpu.push(push);
        for (std::uint32_t i = 0; i < draw.commandCount; ++i)
            gpu.vk->vkCmdDrawIndirect(gpu.cmd, gpu.buffer(draw.commands),
                                      VkDeviceSize{stride} * (draw.firstCommand + i), 1, stride);
    }
}

void recordWedges(PassContext& gpu, const WedgePlan& plan, const WedgePipelines& pipelines)
{
    if (!gpu.clipTo(plan.pixels)) return;
    const Bound constants = gpu.constants(0, volumeConstants(*plan.view, *plan.light, plan.bounded));
    const Bound wedges = gpu.constants(4, wedgeConstants(plan));
    const std::size_t reversed = plan.view->reversed() ? 1 : 0;
    for (const bool before : {true, false}) {
        const PipelineId pipeline = before ? pipelines.before[reversed] : pipelines.around[reversed];
        const MeshView* mesh = nullptr;
        BufferId list;
        for (const VolumeDraw& draw : before ? plan.before : plan.around) {
            if (draw.source.caster->mesh != mesh || draw.list.index != list.index) {
                mesh = draw.source.caster->mesh;
                list = draw.list;
                gpu.bind(pipeline, {constants, gpu.storage(1, mesh->vertexBuffer), gpu.storage(2, plan.receiverBounds),
                                    gpu.storage(3, list), wedges, gpu.storage(5, plan.depths)});
            }
            drawParts(gpu, plan, draw, before);
        }
    }
}

} // namespace

WedgePipelines makeWedgePipelines(const AlgorithmServices& services)
{
    return {.before = {makePipeline(services, "penumbra_wedges.before", false, true),
                       makePipeline(services, "penumbra_wedges.before_reversed", true, true)},
            .around = {makePipeline(services, "penumbra_wedges.around", false, false),
                       makePipeline(services, "penumbra_wedges.around_reversed", true, false)}};
}

const char* missingForWedges(const DeviceTable& vk)
{
    if (const char* missing = missingForStencil(vk)) return missing;
    return supports(vk, kCoverageFormat, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT) ? nullptr
                                                                                       : "needs blending of R32_SFLOAT";
}

gpu::WedgeResolve wedgeResolve(const CameraView& view, const LightView& light)
{
    gpu::WedgeResolve block{};
    block.volumes = volumeResolve(view, light);
    block.entered = mirrors(view) ? -1 : 1;
    return block;
}

WedgePlan* planWedges(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                      std::span<const VolumeList, 2> sides, bool bounded)
{
    WedgePlan* plan = passes.arena().make<WedgePlan>();
    plan->view = task.view;
    plan->light = task.light;
    plan->receiverBounds = stencil.receiverBounds;
    plan->depths = stencil.depths;
    plan->depthColumns = stencil.depthColumns;
    plan->bounded = bounded;
    plan->pixels = lightPixels(*task.light, *task.view);
    for (std::span<VolumeDraw>* draws : {&plan->before, &plan->around})
        *draws = passes.arena().array<VolumeDraw>(mostVolumes(task.casters->all)).first(0);
    for (std::size_t i = 0; i < 2; ++i) {
        collectDraws(*plan, sides[i]);
        plan->lists[i] = sides[i].buffer;
    }
    return plan;
}

ImageId declareWedges(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                      const WedgePlan& plan, const WedgePipelines& pipelines)
{
    // Of the view, as the stencil it belongs to: lights take their turns with both.
    const ImageId coverage = passes.transient(ImageInfo{.name = "penumbra_wedges.coverage",
                                                        .scope = Scope::view,
                                                        .format = kCoverageFormat,
                                                        .extent = task.view->extent});
    PassRef pass = passes.raster(name);
    pass.area(drawnArea(*task.view))
        .writes(coverage, {.clear = true, .value = {.color = {{0.0f, 0.0f, 0.0f, 0.0f}}}, .blend = true})
        .depthTest(stencil.image)
        .reads(stencil.depths)
        .reads(stencil.receiverBounds);
    for (const BufferId list : plan.lists)
        if (list) pass.reads(list).indirect(list);
    const WedgePlan* drawn = &plan;
    const WedgePipelines* used = &pipelines;
    pass.record([=](PassContext& gpu) { recordWedges(gpu, *drawn, *used); });
    return coverage;
}

} // namespace gnomon
