#include "algorithms/volumes/volume_draw.hpp"

#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/silhouette.hpp"
#include "runtime/scene/light_pixels.hpp"

#include "shaders/volumes/all_edges.h"
#include "shaders/volumes_all_edges_vert.h"
#include "shaders/volumes_volume_vert.h"

namespace gnomon {

namespace {

/// Near caps lie on surfaces that the host has drawn with its own arithmetic. Moved away from the eye along the view
/// ray by this share of the distance they are safely behind them, where z-fail counts them. 2^-10: a depth that differs
/// by the rasteriser's 1/256 pixel does so by less up to 89.7 degrees of slope (pixels of 0.001 at distance 1), and
/// nothing visible can lie in between, because the surface hides it.
constexpr float kCapPush = 1.0f / 1024.0f;

/// Of caps whose surface the host may not have drawn (VolumeSource::mayBeUnseen()): where one runs past an edge into a
/// surface that is drawn, what is pushed beyond that is counted behind it. A box drawn from within was wrong on 0.023 %
/// of the pixels with 2^-10, on 0.004 % with 2^-13, which is enough for surfaces that are drawn up to 85 degrees of
/// slope at 640x360, and 87.6 at 1280x720.
constexpr float kUnseenCapPush = 1.0f / 8192.0f;

/// What is added to clip z to move a volume away from the eye by this share of the distance. That scales clip x, y and
/// w alike and leaves z, but for the eye's own clip z (the projection's last column): the same as lowering z by e / (1
/// + e) of it. Without a perspective: by this share of what 700 pixels are wide, where one of 1/700 radian is as wide.
float pushBy(const CameraView& view, float share)
{
    const gpu::ViewConstants& c = view.constants;
    if (gpu::isOrthographic(c)) return 700.0f * share * c.pixelSize / c.rayDepthWs.w;
    return -view.projection[3][2] * share / (1.0f + share);
}

constexpr BindingInfo kVolumeBindings[] = {constantsAt(0), bufferAt(1), bufferAt(2),
                                           bufferAt(3),  // of allEdges
                                           bufferAt(4)}; // likewise

// --- pipelines ---

VkStencilOpState countOp(const VolumeCounting& counting, VkStencilOp pass, VkStencilOp depthFail)
{
    return {.failOp = VK_STENCIL_OP_KEEP,
            .passOp = pass,
            .depthFailOp = depthFail,
            .compareOp = counting.mask ? VK_COMPARE_OP_EQUAL : VK_COMPARE_OP_ALWAYS,
            .compareMask = counting.mask ? counting.mask : 0xffu,
            .writeMask = counting.bits,
            .reference = counting.mask};
}

/// The shader that makes corners of a shape, and what it is given.
void setShape(GraphicsPipelineInfo& info, VolumeShape shape, bool caps)
{
    const std::span<const BindingInfo> bindings = kVolumeBindings;
    if (shape == VolumeShape::lists) {
        info.vertex.code = k_volumes_volume_vert;
        info.bindings = bindings.first(3);
        info.pushBytes = sizeof(gpu::VolumePush);
        return;
    }
    info.vertex = {.code = k_volumes_all_edges_vert, .specializationCount = 1, .specialization = {caps ? 1u : 0u}};
    info.bindings = bindings;
    info.pushBytes = sizeof(gpu::AllEdgesPush);
}

PipelineId makePipeline(const AlgorithmServices& services, const char* name, const VolumeCounting& counting, bool zPass,
                        bool reversed, VolumeShape shape, bool caps)
{
    constexpr VkStencilOp up = VK_STENCIL_OP_INCREMENT_AND_WRAP, down = VK_STENCIL_OP_DECREMENT_AND_WRAP;
    constexpr VkStencilOp keep = VK_STENCIL_OP_KEEP;
    GraphicsPipelineInfo info{.name = name};
    setShape(info, shape, caps);
    info.depthTest = true;
    info.depthCompare = reversed ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS;
    // Entering a volume counts up, leaving it down: before the receiver for z-pass, backwards behind it for z-fail.
    info.stencil = {.enable = true,
                    .front = zPass ? countOp(counting, up, keep) : countOp(counting, keep, down),
                    .back = zPass ? countOp(counting, down, keep) : countOp(counting, keep, up)};
    // z-fail must lose nothing behind the far plane. z-pass must lose what lies before the near plane: the host did.
    info.depthClamp = !zPass && services.vk->enabled.depthClamp;
    info.colorMask = 0;
    info.colorFormat = counting.color;
    info.depthFormat = kStencilFormat;
    return services.pipelines->graphics(info);
}

// --- what is drawn ---

/// Calls choose() with one draw per volume of the list that the view can see.
template <typename Choose>
void collectDraws(const VolumePlan& plan, const VolumeList& list, const Choose& choose)
{
    forDraws(
        list, [&](const Aabb& box) { return shadowTouches(box, *plan.light, plan.view->frustum); }, choose);
}

// --- recording ---

gpu::VolumePush volumePush(const VolumePlan& plan, const VolumeDraw& draw, float clipZ)
{
    gpu::VolumePush push;
    eyeRows(*draw.source.caster, *plan.view, push.rows);
    // Counted with both sides (asFailing()), a face that the light touches has caps: by rounding behind it, the light
    // would be shut out of all that lies before it.
    if (draw.source.closedInOpenMesh()) {
        const glm::vec3 away = awayFromLight(*plan.light, *draw.source.caster, draw.source.cluster);
        for (int row = 0; row < 3; ++row)
            push.rows[row].w += away[row];
    }
    push.reach = glm::vec4(casterReach(draw.bounds, *plan.light, plan.view->eye), clipZ);
    return push;
}

void pushVolume(PassContext& gpu, const VolumePlan& plan, VolumeShape shape, const VolumeDraw& draw, bool caps)
{
    const float share = !caps ? 0.0f : draw.source.mayBeUnseen() ? kUnseenCapPush : kCapPush;
    const gpu::VolumePush push = volumePush(plan, draw, pushBy(*plan.view, share));
    if (shape == VolumeShape::lists) {
        gpu.push(push);
        return;
    }
    const Caster& caster = *draw.source.caster;
    const bool closed = draw.source.shape().closed;
    const bool capsClosed = closed && !draw.source.bothSides;
    gpu::FaceLight light = lightInObjectSpace(*plan.light, caster);
    light.touched = touchedWay(closed, caster.mirrored);
    // Caps as writeCaps() chooses them.
    const std::uint32_t away = caster.mirrored ? gpu::FACE_TOWARDS : gpu::FACE_AWAY;
    gpu.push(gpu::AllEdgesPush{.caster = push,
                               .light = light,
                               .capsWay = capsClosed ? away : gpu::FACE_TOUCHED,
                               .firstPlane = draw.firstPlane});
}

void drawList(PassContext& gpu, const VolumePlan& plan, VolumeShape shape, PipelineId pipeline, const Bound& constants,
              std::span<const VolumeDraw> draws, bool caps)
{
    const MeshView* mesh = nullptr;
    BufferId list;
    for (const VolumeDraw& draw : draws) {
        if (draw.source.caster->mesh != mesh) {
            mesh = draw.source.caster->mesh;
            gpu.bind(pipeline, {constants, gpu.storage(1, mesh->vertexBuffer), gpu.storage(2, plan.receiverBounds),
                                // A mesh's own, where the shape has them.
                                gpu.storage(3, draw.list), gpu.storage(4, draw.planes ? draw.planes : draw.list)});
        }
        if (draw.list.index != list.index) {
            list = draw.list;
            gpu.vk->vkCmdBindIndexBuffer(gpu.cmd, gpu.buffer(list), 0, VK_INDEX_TYPE_UINT32);
        }
        pushVolume(gpu, plan, shape, draw, caps);
        // One by one: more than one at a time needs a device feature, and here a draw costs 0.6 us.
        constexpr std::uint32_t size = sizeof(VkDrawIndexedIndirectCommand);
        for (std::uint32_t i = 0; i < draw.times * draw.commandCount; ++i)
            gpu.vk->vkCmdDrawIndexedIndirect(gpu.cmd, gpu.buffer(draw.commands),
                                             VkDeviceSize{size} * (draw.firstCommand + i % draw.commandCount), 1, size);
    }
}

} // namespace

void eyeRows(const Caster& caster, const CameraView& view, glm::vec4 (&rows)[3])
{
    const glm::vec3 translation = caster.translation - view.eye;
    for (int row = 0; row < 3; ++row)
        rows[row] = glm::vec4(caster.basis[0][row], caster.basis[1][row], caster.basis[2][row], translation[row]);
}

VolumePipelines makeVolumePipelines(const AlgorithmServices& services, const VolumePipelineNames& names,
                                    const VolumeCounting& counting, VolumeShape shape)
{
    VolumePipelines pipelines{.shape = shape};
    for (const int i : {0, 1}) {
        const bool reversed = i != 0;
        pipelines.zPass[i] = makePipeline(services, names.zPass, counting, true, reversed, shape, false);
        pipelines.zFail[i] = makePipeline(services, names.zFail, counting, false, reversed, shape, false);
        pipelines.caps[i] = shape == VolumeShape::lists
                                ? pipelines.zFail[i]
                                : makePipeline(services, names.caps, counting, false, reversed, shape, true);
    }
    return pipelines;
}

VolumePlan* emptyPlan(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, bool bounded)
{
    VolumePlan* plan = passes.arena().make<VolumePlan>();
    plan->view = task.view;
    plan->light = task.light;
    plan->receiverBounds = stencil.receiverBounds;
    plan->bounded = bounded;
    plan->pixels = lightPixels(*task.light, *task.view);
    const std::size_t count = mostVolumes(task.casters->all);
    for (std::span<VolumeDraw>* draws : {&plan->zPass, &plan->zFail, &plan->caps})
        *draws = passes.arena().array<VolumeDraw>(count).first(0);
    return plan;
}

VolumeDraw drawAt(const VolumeList& list, std::uint32_t& piece)
{
    const VolumeSource source = list.pieces[piece].source;
    VolumeDraw draw{.source = source,
                    .bounds = source.bounds(),
                    .list = list.buffer,
                    .commands = list.buffer,
                    .firstCommand = piece};
    while (piece < list.pieces.size() && list.pieces[piece].source == source)
        ++piece;
    draw.commandCount = piece - draw.firstCommand;
    return draw;
}

bool needsZFail(const VolumePlan& plan, const VolumeDraw& draw)
{
    return draw.source.mayBeUnseen() || plan.view->oblique ||
           shadowsNearRectangle(draw.bounds, *plan.light, plan.view->nearCorners);
}

VolumeDraw asFailing(const VolumePlan& plan, VolumeDraw draw)
{
    if (!draw.source.closedInOpenMesh()) return draw;
    draw.source.bothSides =
        plan.view->oblique || overlap(eyeBounds(*plan.view), draw.bounds) || holdsLight(draw.bounds, *plan.light);
    draw.times = draw.source.bothSides ? 2 : 1;
    return draw;
}

void addSides(VolumePlan& plan, const VolumeList& sides, bool zFailForAll)
{
    collectDraws(plan, sides, [&](const VolumeDraw& draw) {
        if (zFailForAll || needsZFail(plan, draw))
            append(plan.zFail, asFailing(plan, draw));
        else
            append(plan.zPass, draw);
    });
}

VolumeList addCaps(PassBuilder& passes, const ShadowTask& task, VolumePlan& plan, std::size_t firstFailing,
                   std::uint32_t variant, const MeshVolumePipelines* device)
{
    const std::span<const VolumeDraw> failing = plan.zFail.subspan(firstFailing);
    const std::span<VolumeSource> volumes = passes.arena().array<VolumeSource>(failing.size());
    for (std::size_t i = 0; i < failing.size(); ++i)
        volumes[i] = failing[i].source;
    const VolumeList caps = declareCaps(passes, task, volumes, variant, device);
    collectDraws(plan, caps, [&](const VolumeDraw& draw) { append(plan.caps, draw); });
    return caps;
}

VolumePlan* planVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, bool bounded,
                        bool zFailForAll, const MeshVolumePipelines* device)
{
    const VolumeList sides[2] = {declareSides(passes, task, true, device), declareSides(passes, task, false, device)};
    return planVolumes(passes, task, stencil, sides, bounded, zFailForAll);
}

VolumePlan* planVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                        std::span<const VolumeList, 2> sides, bool bounded, bool zFailForAll)
{
    VolumePlan* plan = emptyPlan(passes, task, stencil, bounded);
    for (std::uint32_t i = 0; i < 2; ++i) {
        const std::size_t firstFailing = plan->zFail.size();
        addSides(*plan, sides[i], zFailForAll);
        plan->lists[i] = sides[i];
        plan->lists[2 + i] = addCaps(passes, task, *plan, firstFailing, i);
    }
    return plan;
}

void addMeshVolumes(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& device, bool zFailForAll,
                    VolumePlan& plan)
{
    const std::size_t firstFailing = plan.zFail.size();
    plan.lists[4] = declareMeshSides(passes, task, device);
    addSides(plan, plan.lists[4], zFailForAll);
    plan.lists[5] = addCaps(passes, task, plan, firstFailing, kMeshVariant, &device);
}

void usesVolumes(PassRef& pass, const VolumePlan& plan)
{
    pass.reads(plan.receiverBounds);
    for (const VolumeList& list : plan.lists)
        if (list.buffer) pass.indices(list.buffer).indirect(list.buffer);
    for (const BufferId commands : plan.commands)
        if (commands) pass.indirect(commands);
    for (const BufferId list : plan.meshLists)
        pass.indices(list).indirect(list).reads(list);
    for (const BufferId planes : plan.planeLists)
        pass.reads(planes);
}

void drawVolumes(PassContext& gpu, const VolumePlan& plan, const VolumePipelines& pipelines)
{
    const Bound constants = gpu.constants(0, volumeConstants(*plan.view, *plan.light, plan.bounded));
    const std::size_t reversed = plan.view->reversed() ? 1 : 0;
    drawList(gpu, plan, pipelines.shape, pipelines.zPass[reversed], constants, plan.zPass, false);
    drawList(gpu, plan, pipelines.shape, pipelines.zFail[reversed], constants, plan.zFail, false);
    drawList(gpu, plan, pipelines.shape, pipelines.caps[reversed], constants, plan.caps, true);
}

const char* refusesReadSides(const DeviceTable& vk, const ShadowTask& task)
{
    const bool fits =
        fitsBinding(vk, sidesBytes(task.casters->statics)) && fitsBinding(vk, sidesBytes(task.casters->dynamics));
    return fits ? nullptr : "the casters in range have more edges than a storage buffer holds";
}

bool canReadLists(const DeviceTable& vk, const ShadowTask& task)
{
    return !refusesReadSides(vk, task) && fitsBinding(vk, capsBytes(task.casters->all));
}

const char* refusesVolumes(const DeviceTable& vk, const ShadowTask& task)
{
    // Without clamping, z-fail would lose the part of a volume that lies behind a finite far plane.
    if (task.view->convention != GN_DEPTH_REVERSED_INFINITE && !vk.enabled.depthClamp)
        return "a finite far plane needs depthClamp";
    if (const char* reason = refusesView(vk, *task.view)) return reason;
    for (const Caster* caster : task.casters->all) {
        if (caster->alphaTested && !caster->mayBeMissed) return "alpha-tested casters in range";
        if (!caster->mesh || caster->alphaTested) continue; // missed; host-drawn: the runtime decides by the trait
        if (castsByConnectivity(*caster)) continue;         // likewise
        if (!caster->mesh->topology) return "topology of a caster is not built yet";
        if (caster->mesh->positions.size() > vk.properties.limits.maxDrawIndexedIndexValue / 2)
            return "a caster has more vertices than the device's index range";
    }
    return nullptr;
}

} // namespace gnomon
