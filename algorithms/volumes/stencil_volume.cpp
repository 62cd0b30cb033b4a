#include "algorithms/volumes/stencil_volume.hpp"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "runtime/scene/light_pixels.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/view_stencil.hpp"
#include "algorithms/volumes/volume_list.hpp"

#include "shaders/volumes_resolve_frag.h"
#include "shaders/volumes_resolve_vert.h"
#include "shaders/volumes_volume_vert.h"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail };

/// Near caps lie on surfaces that the host has drawn with its own arithmetic. Moved away from the eye along the view
/// ray by this share of the distance they are safely behind them, where z-fail counts them. 2^-10: a depth that differs
/// by the rasteriser's 1/256 pixel does so by less up to 89.7 degrees of slope (pixels of 0.001 at distance 1), and
/// nothing visible can lie in between, because the surface hides it.
constexpr float kCapPush = 1.0f / 1024.0f;

/// A run of indirect commands for one caster.
struct VolumeDraw {
    const Caster* caster = nullptr;
    BufferId list;
    std::uint32_t firstCommand = 0, commandCount = 0;
};

struct Pipelines {
    PipelineId zPass[2], zFail[2]; ///< By reversed depth.
    PipelineId counted, withoutCasters; ///< Resolve: where the stencil is not 0, and everywhere.
    ViewStencilPipelines view;
};

/// What the raster pass draws; in the frame's arena.
struct DrawPlan {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    std::span<VolumeDraw> zPass, zFail, caps; ///< zFail: sides.
    ImageId depth, normals;
    BufferId receiverBounds;
    bool bounded = true;
    VkRect2D pixels{}; ///< Where the light can reach.
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

constexpr BindingInfo kVolumeBindings[] = {{.binding = 0, .kind = BindingKind::constants},
                                           {.binding = 1, .kind = BindingKind::storageBuffer},
                                           {.binding = 2, .kind = BindingKind::storageBuffer}};
constexpr BindingInfo kResolveBindings[] = {
    {.binding = 0, .kind = BindingKind::constants},
    {.binding = 1, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT},
    {.binding = 2, .kind = BindingKind::sampledImage, .format = VK_FORMAT_R16G16B16A16_SFLOAT}};

constexpr VkStencilOpState stencilOp(VkStencilOp pass, VkStencilOp depthFail)
{
    return {.failOp = VK_STENCIL_OP_KEEP,
            .passOp = pass,
            .depthFailOp = depthFail,
            .compareOp = VK_COMPARE_OP_ALWAYS,
            .compareMask = 0xff,
            .writeMask = 0xff,
            .reference = 0};
}

PipelineId makeVolumePipeline(const AlgorithmServices& services, const char* name, bool zPass, bool reversed)
{
    constexpr VkStencilOp up = VK_STENCIL_OP_INCREMENT_AND_WRAP, down = VK_STENCIL_OP_DECREMENT_AND_WRAP;
    constexpr VkStencilOp keep = VK_STENCIL_OP_KEEP;
    GraphicsPipelineInfo info{.name = name,
                              .vertex = {.code = k_volumes_volume_vert},
                              .bindings = kVolumeBindings,
                              .pushBytes = sizeof(gpu::VolumePush)};
    info.depthTest = true;
    info.depthCompare = reversed ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS;
    // Entering a volume counts up, leaving it down: before the receiver for z-pass, backwards behind it for z-fail.
    info.stencil = {.enable = true,
                    .front = zPass ? stencilOp(up, keep) : stencilOp(keep, down),
                    .back = zPass ? stencilOp(down, keep) : stencilOp(keep, up)};
    // z-fail must lose nothing behind the far plane. z-pass must lose what lies before the near plane: the host did.
    info.depthClamp = !zPass && services.vk->enabled.depthClamp;
    info.colorMask = 0;
    info.colorFormat = VK_FORMAT_R8_UNORM;
    info.depthFormat = kStencilFormat;
    return services.pipelines->graphics(info);
}

PipelineId makeResolvePipeline(const AlgorithmServices& services, const char* name, bool counted)
{
    GraphicsPipelineInfo info{
        .name = name,
        .vertex = {.code = k_volumes_resolve_vert},
        .fragment = {.code = k_volumes_resolve_frag, .specializationCount = 1, .specialization = {counted ? 1u : 0u}},
        .bindings = kResolveBindings};
    info.blendScale = !counted;
    if (counted) {
        VkStencilOpState test = stencilOp(VK_STENCIL_OP_KEEP, VK_STENCIL_OP_KEEP);
        test.compareOp = VK_COMPARE_OP_NOT_EQUAL;
        test.writeMask = 0;
        info.stencil = {.enable = true, .front = test, .back = test};
    }
    info.colorFormat = VK_FORMAT_R8_UNORM;
    info.depthFormat = kStencilFormat;
    return services.pipelines->graphics(info);
}

StencilVolume::StencilVolume(const AlgorithmServices& services) : vk_(*services.vk)
{
    pipelines_.zPass[0] = makeVolumePipeline(services, "stencil_volume.z_pass", true, false);
    pipelines_.zPass[1] = makeVolumePipeline(services, "stencil_volume.z_pass_reversed", true, true);
    pipelines_.zFail[0] = makeVolumePipeline(services, "stencil_volume.z_fail", false, false);
    pipelines_.zFail[1] = makeVolumePipeline(services, "stencil_volume.z_fail_reversed", false, true);
    pipelines_.counted = makeResolvePipeline(services, "stencil_volume.counted", true);
    pipelines_.withoutCasters = makeResolvePipeline(services, "stencil_volume.without_casters", false);
    pipelines_.view = makeViewStencilPipelines(services);
}

// --- what is drawn ---

/// Appends one draw per caster of the list whose shadow the view can see.
template <typename Choose>
void collectDraws(const DrawPlan& plan, const VolumeList& list, Choose&& choose)
{
    for (std::uint32_t piece = 0; piece < list.pieces.size();) {
        const Caster* caster = list.pieces[piece].caster;
        VolumeDraw draw{.caster = caster, .list = list.buffer, .firstCommand = piece};
        while (piece < list.pieces.size() && list.pieces[piece].caster == caster)
            ++piece;
        draw.commandCount = piece - draw.firstCommand;
        if (shadowTouches(caster->bounds, *plan.light, plan.view->frustum)) choose(draw);
    }
}

/// Fills the plan's lists of sides. @return the casters that z-fail counts.
std::span<const Caster* const> planSides(PassBuilder& passes, const ShadowTask& task, DrawPlan& plan,
                                         const VolumeList (&lists)[2])
{
    const std::size_t count = task.casters->all.size();
    plan.zPass = passes.arena().array<VolumeDraw>(count);
    plan.zFail = passes.arena().array<VolumeDraw>(count);
    const std::span<const Caster*> failing = passes.arena().array<const Caster*>(count);
    std::size_t zPass = 0, zFail = 0;
    for (const VolumeList& list : lists) {
        collectDraws(plan, list, [&](const VolumeDraw& draw) {
            const bool fail = task.settings[kZFail] != 0.0 ||
                              shadowsNearRectangle(draw.caster->bounds, *task.light, task.view->nearCorners);
            if (fail) failing[zFail] = draw.caster;
            (fail ? plan.zFail[zFail++] : plan.zPass[zPass++]) = draw;
        });
    }
    plan.zPass = plan.zPass.first(zPass);
    plan.zFail = plan.zFail.first(zFail);
    return failing.first(zFail);
}

void planCaps(PassBuilder& passes, DrawPlan& plan, const VolumeList& list)
{
    plan.caps = passes.arena().array<VolumeDraw>(plan.zFail.size());
    std::size_t count = 0;
    collectDraws(plan, list, [&](const VolumeDraw& draw) { plan.caps[count++] = draw; });
    plan.caps = plan.caps.first(count);
}

// --- recording ---

gpu::VolumeConstants volumeConstants(const DrawPlan& plan)
{
    const CameraView& view = *plan.view;
    const LightView& light = *plan.light;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    Aabb nearBounds{view.nearCorners[0], view.nearCorners[0]};
    for (const glm::vec3& corner : view.nearCorners) {
        nearBounds.lower = glm::min(nearBounds.lower, corner);
        nearBounds.upper = glm::max(nearBounds.upper, corner);
    }
    const Aabb range = lightBounds(light);
    gpu::VolumeConstants block;
    block.clipFromEye = glm::mat4(glm::dmat4(view.projection) * glm::dmat4(glm::dmat3(view.viewFromWorld)));
    block.lightEs = directional ? glm::vec4(light.direction(), 0.0f) : glm::vec4(light.position() - view.eye, 1.0f);
    block.nearLowerEs = glm::vec4(nearBounds.lower - view.eye, plan.bounded ? 1.0f : 0.0f);
    block.nearUpperEs = glm::vec4(nearBounds.upper - view.eye, 0.0f);
    block.rangeLowerEs = glm::vec4(range.lower - view.eye, 0.0f);
    block.rangeUpperEs = glm::vec4(range.upper - view.eye, 0.0f);
    return block;
}

gpu::VolumeResolve resolveConstants(const DrawPlan& plan)
{
    const LightView& light = *plan.light;
    const float cosine = light.constants.directionWs.w, range = light.constants.range;
    gpu::VolumeResolve block{};
    block.view = plan.view->constants;
    block.lightEs = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? glm::vec4(-light.direction(), 0.0f)
                                                            : glm::vec4(light.position() - plan.view->eye, 1.0f);
    block.cone = glm::vec4(light.direction(), cosine * std::abs(cosine));
    const VkRect2D& area = plan.view->area;
    block.area = {static_cast<float>(area.offset.x), static_cast<float>(area.offset.y),
                  static_cast<float>(area.extent.width), static_cast<float>(area.extent.height)};
    block.rangeSquared = range * range;
    return block;
}

gpu::VolumePush volumePush(const DrawPlan& plan, const Caster& caster, float nearCopyZ)
{
    gpu::VolumePush push;
    const glm::vec3 translation = caster.translation - plan.view->eye;
    for (int row = 0; row < 3; ++row)
        push.rows[row] = glm::vec4(caster.basis[0][row], caster.basis[1][row], caster.basis[2][row], translation[row]);
    push.reach = glm::vec4(casterReach(caster.bounds, *plan.light, plan.view->eye), nearCopyZ);
    return push;
}

void drawVolumes(PassContext& gpu, const DrawPlan& plan, PipelineId pipeline, const Bound& constants,
                 std::span<const VolumeDraw> draws, float nearCopyZ)
{
    const MeshView* mesh = nullptr;
    BufferId list;
    for (const VolumeDraw& draw : draws) {
        if (draw.caster->mesh != mesh) {
            mesh = draw.caster->mesh;
            gpu.bind(pipeline, {constants, gpu.storage(1, mesh->vertexBuffer), gpu.storage(2, plan.receiverBounds)});
        }
        if (draw.list.index != list.index) {
            list = draw.list;
            gpu.vk->vkCmdBindIndexBuffer(gpu.cmd, gpu.buffer(list), 0, VK_INDEX_TYPE_UINT32);
        }
        gpu.push(volumePush(plan, *draw.caster, nearCopyZ));
        // One by one: more than one at a time needs a device feature, and here a draw costs 0.6 us.
        constexpr std::uint32_t size = sizeof(VkDrawIndexedIndirectCommand);
        for (std::uint32_t i = 0; i < draw.commandCount; ++i)
            gpu.vk->vkCmdDrawIndexedIndirect(gpu.cmd, gpu.buffer(list), VkDeviceSize{size} * (draw.firstCommand + i), 1,
                                             size);
    }
}

void recordVolumes(PassContext& gpu, const DrawPlan& plan, const Pipelines& pipelines)
{
    if (plan.pixels.extent.width == 0) return; // the light reaches no pixel: 1 everywhere, as cleared
    gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &plan.pixels);

    const CameraView& view = *plan.view;
    const Bound constants = gpu.constants(0, volumeConstants(plan));
    const std::size_t reversed = view.reversed() ? 1 : 0;
    drawVolumes(gpu, plan, pipelines.zPass[reversed], constants, plan.zPass, 0.0f);
    drawVolumes(gpu, plan, pipelines.zFail[reversed], constants, plan.zFail, 0.0f);
    // Moving a point away from the eye by the share e scales clip x, y and w alike and leaves z, but for the eye's own
    // clip z (the projection's last column): the same as lowering z by e / (1 + e) of it.
    const float push = -view.projection[3][2] * kCapPush / (1.0f + kCapPush);
    drawVolumes(gpu, plan, pipelines.zFail[reversed], constants, plan.caps, push);

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
    const VolumeList sides[2] = {declareSides(passes, task, true), declareSides(passes, task, false)};

    DrawPlan* plan = passes.arena().make<DrawPlan>();
    plan->view = task.view;
    plan->light = task.light;
    plan->depth = task.depth;
    plan->normals = task.normals;
    plan->receiverBounds = stencil.receiverBounds;
    plan->bounded = task.settings[kBounded] != 0.0;
    plan->pixels = lightPixels(*task.light, *task.view);
    const VolumeList caps = declareCaps(passes, task, planSides(passes, task, *plan, sides));
    planCaps(passes, *plan, caps);

    const VkRect2D& area = task.view->area;
    PassRef pass = passes.raster("stencil_volume.count");
    pass.area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
        .writes(task.visibility, {.layer = task.layer, .clear = true, .value = {.color = {{1.0f, 0.0f, 0.0f, 0.0f}}}})
        .depthTest(stencil.image)
        .stencilWrite(stencil.image, {.clear = true})
        .samples(task.depth)
        .reads(stencil.receiverBounds);
    if (task.normals) pass.samples(task.normals);
    for (const VolumeList& list : {sides[0], sides[1], caps})
        if (list.buffer) pass.indices(list.buffer).indirect(list.buffer);
    const Pipelines* pipelines = &pipelines_;
    pass.record([plan, pipelines](PassContext& gpu) { recordVolumes(gpu, *plan, *pipelines); });
}

const char* StencilVolume::refuses(const ShadowTask& task) const
{
    // Without clamping, z-fail would lose the part of a volume that lies behind a finite far plane.
    if (task.view->convention != GN_DEPTH_REVERSED_INFINITE && !vk_.enabled.depthClamp)
        return "a finite far plane needs depthClamp";
    for (const Caster* caster : task.casters->all) {
        if (caster->alphaTested && !caster->mayBeMissed) return "alpha-tested casters in range";
        if (!caster->mesh) continue; // host-drawn: the runtime decides by the trait
        if (!caster->mesh->topology) return "topology of a caster is not built yet";
        if (caster->mesh->positions.size() > vk_.properties.limits.maxDrawIndexedIndexValue / 2)
            return "a caster has more vertices than the device's index range";
    }
    return nullptr;
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
