// Casters flattened onto the one plane that most visible receivers lie on.
// Source:    J. Blinn, "Me and my (fake) shadow", IEEE CG&A 8(1), 1988; Rautenbach 2008, 2.4.2.
// Reads:     triangles of the casters, receiver depth, geometric normals.     Writes: visibility.
// Strong at: flat grounds: exact edges for the price of drawing the casters once; needs no topology, no map, no
//            stencil.
// Weak at:   everything off the plane, which it shows lit wherever it faces the light.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/shared/face_light.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/volume_count.hpp"
#include "runtime/scene/light_pixels.hpp"

#include "shaders/shared_umbra_frag.h"
#include "shaders/volumes/planar.h"
#include "shaders/volumes_planar_choose_comp.h"
#include "shaders/volumes_planar_resolve_frag.h"
#include "shaders/volumes_planar_tiles_comp.h"
#include "shaders/volumes_planar_vert.h"
#include "shaders/volumes_resolve_vert.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kTileGroup = 64; // invocations of planar_tiles.comp

struct Pipelines {
    PipelineId tiles, choose, casters, resolve;
};

/// What the passes of a task share; in the frame's arena.
struct Plan {
    gpu::PlaneChoice choice;
    gpu::PlanarConstants constants;
    gpu::VolumeResolve resolve;
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    std::span<const Caster* const> casters;
    BufferId tiles, plane;
    ImageId depth, normals;
    VkRect2D pixels{}; ///< Where the light can reach.
};

// --- pipelines ---

constexpr BindingInfo kDepthBinding = sampledAt(1, VK_FORMAT_D32_SFLOAT);

PipelineId castersPipeline(const AlgorithmServices& services)
{
    return services.pipelines->graphics({.name = "projected_planar.casters",
                                         .vertex = {.code = k_volumes_planar_vert},
                                         .fragment = {.code = k_shared_umbra_frag},
                                         .bindings = std::array{constantsAt(0), bufferAt(1), bufferAt(2)},
                                         .pushBytes = sizeof(gpu::PlanarPush),
                                         .colorFormat = VK_FORMAT_R8_UNORM});
}

PipelineId resolvePipeline(const AlgorithmServices& services)
{
    constexpr BindingInfo bindings[] = {constantsAt(0), kDepthBinding, sampledAt(2, VK_FORMAT_R16G16B16A16_SFLOAT),
                                        bufferAt(3)};
    return services.pipelines->graphics({.name = "projected_planar.resolve",
                                         .vertex = {.code = k_volumes_resolve_vert},
                                         .fragment = {.code = k_volumes_planar_resolve_frag},
                                         .bindings = bindings,
                                         .blendScale = true,
                                         .colorFormat = VK_FORMAT_R8_UNORM});
}

// --- what there is ---

gpu::uvec4 tileGrid(const CameraView& view)
{
    const std::uint32_t x = view.area.extent.width / gpu::PLANE_TILE, y = view.area.extent.height / gpu::PLANE_TILE;
    return {x, y, x * y, 0};
}

gpu::PlaneChoice planeChoice(const CameraView& view, const gpu::VolumeResolve& resolve)
{
    gpu::PlaneChoice choice{};
    choice.view = view.constants;
    choice.lightEs = resolve.lightEs;
    choice.cone = resolve.cone;
    choice.middle = {resolve.area.x + 0.5f * resolve.area.z, resolve.area.y + 0.5f * resolve.area.w, resolve.area.x,
                     resolve.area.y};
    choice.grid = tileGrid(view);
    choice.rangeSquared = resolve.rangeSquared;
    return choice;
}

Plan* makePlan(PassBuilder& passes, const ShadowTask& task)
{
    Plan* plan = passes.arena().make<Plan>();
    plan->view = task.view;
    plan->light = task.light;
    plan->resolve = volumeResolve(*task.view, *task.light);
    plan->choice = planeChoice(*task.view, plan->resolve);
    plan->constants.clipFromEye = clipFromEye(*task.view);
    plan->constants.lightEs = plan->resolve.lightEs;
    plan->depth = task.depth;
    plan->normals = task.normals ? task.normals : task.depth; // without normals the shader does not read them
    plan->pixels = lightPixels(*task.light, *task.view);

    const std::span<const Caster*> casters = passes.arena().array<const Caster*>(task.casters->all.size());
    std::size_t count = 0;
    for (const Caster* caster : task.casters->all)
        if (caster->mesh && !caster->hostDrawn && !caster->alphaTested &&
            shadowTouches(caster->bounds, *task.light, task.view->frustum))
            casters[count++] = caster;
    plan->casters = casters.first(count);
    return plan;
}

// --- passes ---

void declarePlane(PassBuilder& passes, const Pipelines& pipelines, Plan& plan)
{
    const std::uint32_t tileCount = plan.choice.grid.z;
    plan.tiles = passes.transient(BufferInfo{.name = "projected_planar.tiles",
                                             .scope = Scope::view,
                                             .size = VkDeviceSize{sizeof(gpu::TilePlane)} * tileCount});
    plan.plane = passes.transient(BufferInfo{.name = "projected_planar.plane", .size = sizeof(gpu::ReceiverPlane)});
    const Plan* shared = &plan;
    passes.compute("projected_planar.tiles", Scope::view)
        .samples(plan.depth)
        .writes(plan.tiles)
        .record([=, pipeline = pipelines.tiles](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, shared->choice),
                                gpu.sampled(1, shared->depth, SamplerKind::nearest, 0), gpu.storage(2, shared->tiles)});
            gpu.vk->vkCmdDispatch(gpu.cmd, (tileCount + kTileGroup - 1) / kTileGroup, 1, 1);
        });
    passes.compute("projected_planar.choose")
        .reads(plan.tiles)
        .writes(plan.plane)
        .record([=, pipeline = pipelines.choose](PassContext& gpu) {
            gpu.bind(pipeline,
                     {gpu.constants(0, shared->choice), gpu.storage(1, shared->tiles), gpu.storage(2, shared->plane)});
            gpu.vk->vkCmdDispatch(gpu.cmd, 1, 1, 1);
        });
}

void drawCasters(PassContext& gpu, const Plan& plan, PipelineId pipeline)
{
    const Bound constants = gpu.constants(0, plan.constants);
    const MeshView* mesh = nullptr;
    for (const Caster* caster : plan.casters) {
        if (caster->mesh != mesh) {
            mesh = caster->mesh;
            gpu.bind(pipeline, {constants, gpu.storage(1, mesh->vertexBuffer), gpu.storage(2, plan.plane)});
            gpu.vk->vkCmdBindIndexBuffer(gpu.cmd, mesh->indexBuffer, 0, VK_INDEX_TYPE_UINT32);
        }
        const std::uint32_t all = mesh->triangleCount();
        forDrawnParts(*plan.light, *caster, [&](const DrawnPart& part) {
            gpu::PlanarPush push;
            eyeRows(*caster, *plan.view, push.rows);
            for (int row = 0; row < 3; ++row)
                push.rows[row].w += part.away[row];
            gpu.push(push);
            gpu.vk->vkCmdDrawIndexed(gpu.cmd, 3 * std::min(all, part.faceCount), 1, 3 * part.firstFace, 0, 0);
        });
    }
}

class ProjectedPlanar final : public ShadowAlgorithm {
public:
    explicit ProjectedPlanar(const AlgorithmServices& services)
        : pipelines_{services.pipelines->compute("projected_planar.tiles", {k_volumes_planar_tiles_comp},
                                                 {constantsAt(0), kDepthBinding, bufferAt(2)}),
                     services.pipelines->compute("projected_planar.choose", {k_volumes_planar_choose_comp},
                                                 {constantsAt(0), bufferAt(1), bufferAt(2)}),
                     castersPipeline(services), resolvePipeline(services)}
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        Plan* plan = makePlan(passes, task);
        declarePlane(passes, pipelines_, *plan);
        PassRef pass = passes.raster("projected_planar.shadows");
        pass.area(drawnArea(*task.view))
            .writes(task.visibility,
                    {.layer = task.layer, .clear = true, .value = {.color = {{1.0f, 0.0f, 0.0f, 0.0f}}}})
            .samples(task.depth)
            .reads(plan->plane);
        if (task.normals) pass.samples(task.normals);
        pass.record([plan, pipelines = &pipelines_](PassContext& gpu) {
            if (!gpu.clipTo(plan->pixels)) return; // the light reaches no pixel: 1 everywhere, as cleared
            drawCasters(gpu, *plan, pipelines->casters);
            gpu.bind(pipelines->resolve,
                     {gpu.constants(0, plan->resolve), gpu.sampled(1, plan->depth, SamplerKind::nearest, 0),
                      gpu.sampled(2, plan->normals, SamplerKind::nearest, 0), gpu.storage(3, plan->plane)});
            gpu.drawFullscreen();
        });
    }

    const char* refuses(const ShadowTask& task) const override
    {
        if (gpu::isOrthographic(task.view->constants)) return "the view has no perspective, which planes are found by";
        if (tileGrid(*task.view).z == 0) return "the view is smaller than a tile of 16 pixels";
        for (const Caster* caster : task.casters->all)
            if (caster->alphaTested && !caster->mayBeMissed) return "alpha-tested casters in range";
        return nullptr;
    }

private:
    Pipelines pipelines_;
};

const char* missing(const DeviceTable& vk)
{
    return vk.enabled.shaderClipDistance ? nullptr : "needs shaderClipDistance";
}

} // namespace

const AlgorithmEntry kProjectedPlanar{
    .name = "projected_planar",
    .source = "Blinn 1988; Rautenbach 2008, 2.4.2",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_PLANAR_BIT,
    .memoryPerLight =
        [](std::span<const double>, VkExtent2D extent, GnLightType) {
            const VkDeviceSize tiles = VkDeviceSize{extent.width / gpu::PLANE_TILE} * (extent.height / gpu::PLANE_TILE);
            return pooledSize(sizeof(gpu::TilePlane) * tiles) + pooledSize(sizeof(gpu::ReceiverPlane));
        },
    .missing = missing,
    .create = makeAlgorithm<ProjectedPlanar>,
    .typicalWrongPercent = 55.5f, // projected_planar.md, rooms: what the rules are there to prevent
};

} // namespace gnomon
