// A depth map answers where the texels around a receiver agree; where they do not, shadow volumes are counted.
// Source:    E. Chan and F. Durand, "An efficient hybrid shadow rendering algorithm", EGSR 2004; Rautenbach 2008, 3.4.
// Reads:     casters' triangles and topology, receiver depth, geometric normals.     Writes: visibility.
// Strong at: exact edges from a coarse map, without rays; it may be recorded. Volumes fill few pixels.
// Weak at:   what is thinner than a texel may be missed; map, look-up and volumes are all paid for.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/volumes/light_cells.hpp"
#include "algorithms/volumes/view_stencil.hpp"
#include "algorithms/volumes/volume_draw.hpp"

#include "shaders/shared_fullscreen_vert.h"
#include "shaders/shared_map_resolve_vert.h"
#include "shaders/shared_umbra_frag.h"
#include "shaders/volumes_chan_durand_cube_frag.h"
#include "shaders/volumes_chan_durand_cull_comp.h"
#include "shaders/volumes_chan_durand_frag.h"

namespace gnomon {

namespace {

// widen: faces of a cube overlap by four texels, of which the four that vote take one.
constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 512, true},
    {"widen", "Texels by which the 2 x 2 that must agree are widened to each side.", 0, gpu::MAX_WIDEN, 0},
    {"cull", "1: only volumes that hold silhouette pixels are drawn; 0: all whose shadow the view can see.", 0, 1, 1},
};
enum Setting : std::size_t { kResolution, kWiden, kCull };

/// The stencil: bit 7 marks silhouette pixels, bits 0 to 6 count there.
constexpr VolumeCounting kCounting{.bits = 0x7f, .mask = 0x80};

constexpr VolumePipelineNames kVolumeNames{.zPass = "chan_durand.z_pass", .zFail = "chan_durand.z_fail"};

struct Pipelines {
    DepthMapPipelines casters;
    ViewStencilPipelines view;
    PipelineId classify[2][2][2]; ///< [cube][has normals][widened]
    PipelineId cull;
    VolumePipelines volumes;
    PipelineId umbra;
};

/// A command of one of the plan's lists, and whose it is.
struct CullSource {
    VolumeSource volume;
    Aabb bounds;
    std::uint32_t list = 0, command = 0; ///< As gpu::CullItem.
};

/// What the passes of one task share; in the frame's arena.
struct Plan {
    gpu::ChanDurandConstants constants{};
    LightMap map;
    ViewStencil stencil;
    VolumePlan* volumes = nullptr;
    BufferId cells;
    std::span<CullSource> sources; ///< Empty: nothing is culled.
    BufferId items, commands;      ///< One of either per source.
};

// --- pipelines ---

PipelineId classifyPipeline(const AlgorithmServices& services, bool cube, bool normals, bool widened)
{
    BindingInfo bindings[5];
    std::ranges::copy(lookupBindings(cube), bindings);
    bindings[4] = bufferAt(5);
    GraphicsPipelineInfo pipeline;
    pipeline.name = "chan_durand.classify";
    pipeline.vertex.code = k_shared_map_resolve_vert;
    pipeline.fragment.code = cube ? std::span<const std::uint32_t>(k_volumes_chan_durand_cube_frag)
                                  : std::span<const std::uint32_t>(k_volumes_chan_durand_frag);
    pipeline.fragment.specializationCount = 2;
    pipeline.fragment.specialization[0] = normals;
    pipeline.fragment.specialization[1] = widened;
    pipeline.bindings = bindings;
    // Depth 1 passes against every depth there is, depth 0 against 0 alone: no silhouette is on the sky of reversed
    // depth, and a receiver exactly on the near plane of standard depth keeps its 0.5, which is lit.
    pipeline.depthTest = true;
    pipeline.depthCompare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    pipeline.stencil = stencilTest(VK_COMPARE_OP_ALWAYS, kCounting.mask, VK_STENCIL_OP_KEEP, 0xff);
    pipeline.stencil.front.depthFailOp = pipeline.stencil.back.depthFailOp = VK_STENCIL_OP_REPLACE;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    pipeline.depthFormat = kStencilFormat;
    return services.pipelines->graphics(pipeline);
}

PipelineId umbraPipeline(const AlgorithmServices& services)
{
    return services.pipelines->graphics(
        {.name = "chan_durand.umbra",
         .vertex = {.code = k_shared_fullscreen_vert},
         .fragment = {.code = k_shared_umbra_frag},
         .stencil = stencilTest(VK_COMPARE_OP_LESS, kCounting.mask), // the mask alone < what is there: mask and a count
         .colorFormat = VK_FORMAT_R8_UNORM,
         .depthFormat = kStencilFormat});
}

// --- culling ---

VkDeviceSize cellBytes(std::size_t layers)
{
    return VkDeviceSize{sizeof(std::uint32_t)} * gpu::CELLS * gpu::CELLS * layers;
}

/// Lists the commands of all draws, and has the draws take theirs from plan.commands, in the order of that list.
void redirectCommands(FrameArena& arena, Plan& plan)
{
    VolumePlan& volumes = *plan.volumes;
    const std::span<VolumeDraw> all[] = {volumes.zPass, volumes.zFail, volumes.caps};
    std::size_t count = 0;
    for (const std::span<VolumeDraw> draws : all)
        for (const VolumeDraw& draw : draws)
            count += draw.commandCount;
    plan.sources = arena.array<CullSource>(count);
    std::uint32_t next = 0;
    for (const std::span<VolumeDraw> draws : all) {
        for (VolumeDraw& draw : draws) {
            std::uint32_t list = 0;
            while (volumes.lists[list].buffer.index != draw.list.index)
                ++list;
            const std::uint32_t first = next;
            for (std::uint32_t i = 0; i < draw.commandCount; ++i)
                plan.sources[next++] = {draw.source, draw.bounds, list, draw.firstCommand + i};
            draw.firstCommand = first;
        }
    }
}

std::uint64_t itemStamp(const Plan& plan, std::uint32_t resolution)
{
    Stamp stamp;
    stamp.add(std::uint64_t{resolution});
    for (const LightFit& fit : plan.map.fits)
        stamp.add(fit.clipFromWorld);
    for (const CullSource& source : plan.sources)
        stamp.add(*source.volume.caster)
            .add(std::uint64_t{source.volume.cluster})
            .add((std::uint64_t{source.list} << 32) | source.command);
    return stamp.value();
}

void writeItems(const Plan& plan, const LightView& light, const HostContext& host, std::uint32_t resolution)
{
    const std::span<gpu::CullItem> items = host.write<gpu::CullItem>(plan.items);
    for (std::size_t i = 0; i < plan.sources.size(); ++i) {
        const CullSource& source = plan.sources[i];
        gpu::CullItem item{.list = source.list, .command = source.command};
        item.footprintCount = cellFootprints(plan.map.fits, light, resolution, source.bounds, item.footprints);
        items[i] = item;
    }
}

void recordCull(PassContext& gpu, const Plan& plan, PipelineId pipeline)
{
    const auto list = [&](std::uint32_t i) { // one that is not there is not read
        const BufferId buffer = plan.volumes->lists[i].buffer;
        return gpu.storage(2 + i, buffer ? buffer : plan.items);
    };
    gpu.bind(pipeline, {gpu.storage(0, plan.items), gpu.storage(1, plan.cells), list(0), list(1), list(2), list(3),
                        gpu.storage(6, plan.commands)});
    const auto count = static_cast<std::uint32_t>(plan.sources.size());
    gpu.push(count);
    gpu.vk->vkCmdDispatch(gpu.cmd, (count + 63) / 64, 1, 1);
}

/// Declares which commands the volumes are drawn with, those of casters that shadow no silhouette pixel zero times.
void declareCull(PassBuilder& passes, const ShadowTask& task, Plan& plan, PipelineId pipeline)
{
    redirectCommands(passes.arena(), plan);
    if (plan.sources.empty()) return;
    plan.items = passes.persistent(BufferInfo{.name = "chan_durand.items",
                                              .size = plan.sources.size() * sizeof(gpu::CullItem),
                                              .place = BufferPlace::upload});
    plan.commands = passes.transient(
        BufferInfo{.name = "chan_durand.commands", .size = plan.sources.size() * sizeof(VkDrawIndexedIndirectCommand)});
    for (const std::span<VolumeDraw> draws : {plan.volumes->zPass, plan.volumes->zFail, plan.volumes->caps})
        for (VolumeDraw& draw : draws)
            draw.commands = plan.commands;

    const Plan* shared = &plan;
    const LightView* light = task.light;
    const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
    if (passes.stale(plan.items, itemStamp(plan, resolution)))
        passes.prepare("chan_durand.footprints").writes(plan.items).run([=](HostContext& host) {
            writeItems(*shared, *light, host, resolution);
        });
    else
        passes.kept();
    PassRef cull = passes.compute("chan_durand.cull");
    cull.reads(plan.items).reads(plan.cells).writes(plan.commands);
    for (const VolumeList& list : plan.volumes->lists)
        if (list.buffer) cull.reads(list.buffer);
    cull.record([=](PassContext& gpu) { recordCull(gpu, *shared, pipeline); });
}

// --- the method ---

class ChanDurand final : public ShadowAlgorithm {
public:
    explicit ChanDurand(const AlgorithmServices& services) : vk_(*services.vk)
    {
        pipelines_.casters = makeDepthMapPipelines(services);
        pipelines_.view = makeViewStencilPipelines(services);
        for (const bool cube : {false, true})
            for (const bool normals : {false, true})
                for (const bool widened : {false, true})
                    pipelines_.classify[cube][normals][widened] = classifyPipeline(services, cube, normals, widened);
        pipelines_.cull = services.pipelines->compute(
            "chan_durand.cull", {k_volumes_chan_durand_cull_comp},
            {bufferAt(0), bufferAt(1), bufferAt(2), bufferAt(3), bufferAt(4), bufferAt(5), bufferAt(6)},
            sizeof(std::uint32_t));
        pipelines_.volumes = makeVolumePipelines(services, kVolumeNames, kCounting);
        pipelines_.umbra = umbraPipeline(services);
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        Plan& plan = *passes.arena().make<Plan>();
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        plan.constants.base = mapConstants(task, resolution, 1);
        plan.constants.widen = static_cast<int>(task.settings[kWiden]);
        plan.map = declareLightMap(passes, pipelines_.casters, task, resolution, plan.constants.base);
        plan.stencil = declareViewStencil(passes, pipelines_.view, task);
        plan.volumes = planVolumes(passes, task, plan.stencil, true, false);
        plan.cells = passes.transient(BufferInfo{.name = "chan_durand.cells", .size = cellBytes(plan.map.fits.size())});
        declareClassify(passes, task, plan);
        if (task.settings[kCull] != 0.0 && canReadLists(vk_, task)) declareCull(passes, task, plan, pipelines_.cull);
        declareCount(passes, task, plan);
    }

    const char* refuses(const ShadowTask& task) const override { return refusesVolumes(vk_, task); }

private:
    void declareClassify(PassBuilder& passes, const ShadowTask& task, const Plan& plan) const
    {
        const BufferId cells = plan.cells;
        passes.transfer("chan_durand.clear").writes(cells).record([=](PassContext& gpu) {
            gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(cells), 0, VK_WHOLE_SIZE, 0);
        });
        const LookupImages look(task, plan.map.image);
        const bool cube = task.light->type == GN_LIGHT_TYPE_POINT, widened = plan.constants.widen > 0;
        const PipelineId pipeline = pipelines_.classify[cube][look.hasNormals][widened];
        const Plan* shared = &plan;
        PassRef pass = passes.raster("chan_durand.classify");
        pass.area(drawnArea(*task.view))
            .writes(task.visibility, visibilityIn(*task.view, task.layer, {}))
            .depthTest(plan.stencil.image)
            .stencilWrite(plan.stencil.image, {.clear = true})
            .updates(cells);
        look.uses(pass);
        pass.record([=](PassContext& gpu) {
            if (!gpu.clipTo(shared->volumes->pixels)) return; // the light reaches no pixel: 1 everywhere, as cleared
            gpu.bind(pipeline,
                     {gpu.constants(0, shared->constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                      gpu.sampled(4, look.map, SamplerKind::nearestBorderFar), gpu.storage(5, cells)});
            gpu.drawFullscreen();
        });
    }

    void declareCount(PassBuilder& passes, const ShadowTask& task, const Plan& plan) const
    {
        PassRef pass = passes.raster("chan_durand.count");
        pass.area(drawnArea(*task.view))
            .writes(task.visibility, {.layer = task.layer, .blend = true})
            .depthTest(plan.stencil.image)
            .stencilWrite(plan.stencil.image);
        usesVolumes(pass, *plan.volumes);
        if (plan.commands) pass.indirect(plan.commands);
        const Plan* shared = &plan;
        const Pipelines* pipelines = &pipelines_;
        pass.record([=](PassContext& gpu) {
            if (!gpu.clipTo(shared->volumes->pixels)) return;
            drawVolumes(gpu, *shared->volumes, pipelines->volumes);
            gpu.bind(pipelines->umbra, {});
            gpu.drawFullscreen();
        });
    }

    const DeviceTable& vk_;
    Pipelines pipelines_;
};

} // namespace

const AlgorithmEntry kChanDurand{
    .name = "chan_durand",
    .source = "Chan and Durand 2004; Rautenbach 2008, 3.3.2",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), mapLayers(type)) +
                   pooledSize(cellBytes(mapLayers(type))) + viewStencilMemory(extent);
        },
    .missing = [](const DeviceTable& vk) -> const char* {
        return vk.enabled.fragmentStoresAndAtomics ? missingForStencil(vk) : "needs fragmentStoresAndAtomics";
    },
    .create = makeAlgorithm<ChanDurand>,
    .typicalWrongPercent = 0.037f, // chan_durand.md, colonnade
};

} // namespace gnomon
