// Soft shadows of spherical lights: hard volumes counted from the light's centre, and a wedge under every
// silhouette edge in which a fragment shader integrates, in closed form, how much of the light's disc the edge
// covers or uncovers.
// Source:    Akenine-Moeller and Assarsson 2002; Assarsson and Akenine-Moeller 2003; Rautenbach 2008, 2.4.4.3.
// Reads:     topology and positions of the casters, receiver depth, geometric normals.     Writes: visibility.
// Strong at: penumbrae that follow light, caster and receiver, without noise and without a map; hard at contacts.
// Weak at:   casters that overlap (their coverage adds up); silhouettes as the light's centre sees them; fill.
#include "algorithms/entries.hpp"

#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/volume_count.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/volumes/wedge.h"

#include "shaders/volumes_resolve_vert.h"
#include "shaders/volumes_wedge_frag.h"
#include "shaders/volumes_wedge_resolve_frag.h"
#include "shaders/volumes_wedge_vert.h"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes and wedges end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail };

constexpr VolumeCountNames kNames{.volumes = {.zPass = "penumbra_wedges.z_pass", .zFail = "penumbra_wedges.z_fail"},
                                  .resolve = "penumbra_wedges.hard"};

// --- wedges under the sides of volumes ---

/// Coverage beyond the stencil's count, and how many edges may have it off by one (wedge.frag, wedge_resolve.frag).
/// Hundreds of edges of a fine mesh add up at a pixel; in sixteen bits that came out wrong by up to a 25th.
constexpr VkFormat kCoverageFormat = VK_FORMAT_R32_SFLOAT;

struct WedgePipelines {
    PipelineId before[2], around[2]; ///< By reversed depth; see WedgePlan.
};
/// In the frame's arena.
struct WedgePlan {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    // Of sides, whose lists the wedges read. Casters whose penumbra is clear of the near rectangle, of which the near
    // sides of hulls are drawn, and the others.
    std::span<VolumeDraw> before, around;
    BufferId lists[2]; ///< Null ids: none.
    BufferId receiverBounds;
    BufferId depths; ///< As ViewStencil's.
    std::uint32_t depthColumns = 0;
    bool bounded = true;
    VkRect2D pixels{}; ///< Where the light can reach.
};

constexpr BindingInfo kWedgeBindings[] = {constantsAt(0), bufferAt(1),    bufferAt(2),
                                          bufferAt(3),    constantsAt(4), bufferAt(5)};

/// @param before the hull's near side where it lies before the receiver; else its far side where that lies behind.
/// Either meets every pixel of the penumbra once and leaves it to the shader to find out about the other side. The near
/// side lets go of what lies behind walls and under the ground, most of what wedges cover; the eye must not be inside.
PipelineId makeWedgePipeline(const AlgorithmServices& services, const char* name, bool reversed, bool before)
{
    return services.pipelines->graphics(
        {.name = name,
         .vertex = {.code = k_volumes_wedge_vert},
         .fragment = {.code = k_volumes_wedge_frag},
         .bindings = kWedgeBindings,
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

WedgePipelines makeWedgePipelines(const AlgorithmServices& services)
{
    return {.before = {makeWedgePipeline(services, "penumbra_wedges.before", false, true),
                       makeWedgePipeline(services, "penumbra_wedges.before_reversed", true, true)},
            .around = {makeWedgePipeline(services, "penumbra_wedges.around", false, false),
                       makeWedgePipeline(services, "penumbra_wedges.around_reversed", true, false)}};
}

/// Null, or why the device cannot add up wedges.
const char* missingForWedges(const DeviceTable& vk)
{
    if (const char* missing = missingForStencil(vk)) return missing;
    return supports(vk, kCoverageFormat, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT) ? nullptr
                                                                                       : "needs blending of R32_SFLOAT";
}

/// What wedge_resolve.frag asks of view and light.
gpu::WedgeResolve wedgeResolve(const CameraView& view, const LightView& light)
{
    gpu::WedgeResolve block{};
    block.volumes = volumeResolve(view, light);
    block.entered = mirrors(view) ? -1 : 1;
    block.radius = light.constants.sourceRadius;
    return block;
}

/// Those casters of two lists of sides whose penumbra the view can see.
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

/// Declares the pass that adds up the wedges. @return of kCoverageFormat, by task
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

// --- the method ---

PipelineId makeResolvePipeline(const AlgorithmServices& services)
{
    constexpr BindingInfo bindings[] = {
        constantsAt(0),
        sampledAt(1, VK_FORMAT_D32_SFLOAT),
        sampledAt(2, VK_FORMAT_R16G16B16A16_SFLOAT),
        {.binding = 3, .kind = BindingKind::sampledImage, .format = kStencilFormat, .stencil = true},
        sampledAt(4, kCoverageFormat)};
    return services.pipelines->graphics({.name = "penumbra_wedges.resolve",
                                         .vertex = {.code = k_volumes_resolve_vert},
                                         .fragment = {.code = k_volumes_wedge_resolve_frag},
                                         .bindings = bindings,
                                         .colorFormat = VK_FORMAT_R8_UNORM});
}

class PenumbraWedges final : public ShadowAlgorithm {
public:
    explicit PenumbraWedges(const AlgorithmServices& services)
        : vk_(*services.vk), count_(makeVolumeCountPipelines(services, kNames)),
          view_(makeViewStencilPipelines(services)), wedges_(makeWedgePipelines(services)),
          resolve_(makeResolvePipeline(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override
    {
        const char* reason = refusesVolumes(vk_, task);
        return reason ? reason : refusesReadSides(vk_, task);
    }

private:
    const DeviceTable& vk_;
    VolumeCountPipelines count_;
    ViewStencilPipelines view_;
    WedgePipelines wedges_;
    PipelineId resolve_;
};

/// Counts only; what the counts mean is for the resolve pass to say.
void declareVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, const VolumePlan& volumes,
                    const VolumePipelines& pipelines)
{
    StencilResolve* resolve = passes.arena().make<StencilResolve>();
    PassRef pass = declareStencilPass(passes, task, "penumbra_wedges.count", stencil, *resolve);
    usesVolumes(pass, volumes);
    pass.record([plan = &volumes, used = &pipelines](PassContext& gpu) {
        if (!gpu.clipTo(plan->pixels)) return;
        drawVolumes(gpu, *plan, *used);
    });
}

struct ResolveInputs {
    gpu::WedgeResolve constants{};
    ImageId depth, normals, stencil, coverage;
    VkRect2D pixels{};
};

void declareResolve(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, ImageId coverage,
                    PipelineId pipeline)
{
    ResolveInputs* inputs = passes.arena().make<ResolveInputs>();
    *inputs = {.constants = wedgeResolve(*task.view, *task.light),
               .depth = task.depth,
               .normals = task.normals ? task.normals : task.depth, // without normals the shader does not read them
               .stencil = stencil.image,
               .coverage = coverage,
               .pixels = lightPixels(*task.light, *task.view)};
    PassRef pass = passes.raster("penumbra_wedges.resolve");
    pass.area(drawnArea(*task.view))
        .writes(task.visibility, {.layer = task.layer, .blend = true}) // 1 outside of `pixels`, as the count left it
        .samples(task.depth)
        .samples(stencil.image)
        .samples(coverage);
    if (task.normals) pass.samples(task.normals);
    pass.record([=](PassContext& gpu) {
        if (!gpu.clipTo(inputs->pixels)) return;
        gpu.bind(pipeline, {gpu.constants(0, inputs->constants), gpu.sampled(1, inputs->depth, SamplerKind::nearest, 0),
                            gpu.sampled(2, inputs->normals, SamplerKind::nearest, 0), gpu.stencilOf(3, inputs->stencil),
                            gpu.sampled(4, inputs->coverage, SamplerKind::nearest, 0)});
        gpu.drawFullscreen();
    });
}

void PenumbraWedges::declare(PassBuilder& passes, const ShadowTask& task)
{
    const bool bounded = task.settings[kBounded] != 0.0, zFail = task.settings[kZFail] != 0.0;
    const ViewStencil stencil = declareViewStencil(passes, view_, task);
    const VolumeList sides[2] = {declareSides(passes, task, true), declareSides(passes, task, false)};
    const VolumePlan* volumes = planVolumes(passes, task, stencil, sides, bounded, zFail);
    if (task.light->constants.sourceRadius <= 0.0f) { // no penumbra: stencil_volume
        declareCount(passes, task, "penumbra_wedges.count", stencil, *volumes, count_);
        return;
    }
    declareVolumes(passes, task, stencil, *volumes, count_.volumes);
    const WedgePlan* wedges = planWedges(passes, task, stencil, sides, bounded);
    const ImageId coverage = declareWedges(passes, task, "penumbra_wedges.wedges", stencil, *wedges, wedges_);
    declareResolve(passes, task, stencil, coverage, resolve_);
}

VkDeviceSize memoryPerLight(std::span<const double>, VkExtent2D extent, GnLightType)
{
    return viewStencilMemory(extent) + storedImageSize(extent, 4); // coverage
}

} // namespace

const AlgorithmEntry kPenumbraWedges{
    .name = "penumbra_wedges",
    .source = "Assarsson and Akenine-Moeller 2003; Rautenbach 2008, 2.4.4.3",
    .traits = GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .missing = missingForWedges,
    .create = makeAlgorithm<PenumbraWedges>,
    .typicalWrongPercent = 0.004f, // stencil_volume's: lights of shipped scenes have no radius
};

} // namespace gnomon
