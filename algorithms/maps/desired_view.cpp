#include "algorithms/maps/desired_view.hpp"

#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/maps_desired_view_comp.h"
#include "shaders/maps_desired_view_crop_comp.h"
#include "shaders/maps_desired_view_vert.h"
#include "shaders/maps_shadow_map_cropped_frag.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kPixelsPerGroup = 8 * 4; // a side, of desired_view.comp

constexpr BindingInfo kResolveView[] = {bufferAt(5)};

DepthMapPipelines castersPipelines(const AlgorithmServices& services)
{
    constexpr BindingInfo bindings[] = {constantsAt(0), bufferAt(1)};
    GraphicsPipelineInfo info = depthCasterPipeline(services);
    info.name = "desired_view.casters";
    info.vertex.code = k_maps_desired_view_vert;
    info.bindings = bindings;
    return {services.pipelines->graphics(info), info.depthClamp ? Clamped::own : Clamped::none};
}

} // namespace

DesiredViewMap::DesiredViewMap(const AlgorithmServices& services)
    : casters_(castersPipelines(services)),
      crop_(services.pipelines->compute("desired_view.crop", {k_maps_desired_view_crop_comp},
                                        {constantsAt(0), bufferAt(1)})),
      resolve_(services,
               {.name = "desired_view.resolve", .fragment = k_maps_shadow_map_cropped_frag, .more = kResolveView})
{
    for (const bool normals : {false, true})
        seen_[normals] = services.pipelines->compute(
            "desired_view.seen", {k_maps_desired_view_comp, 2, {normals, 0}},
            {constantsAt(0), bufferAt(1), lookupBindings(false)[1], lookupBindings(false)[2]});
}

bool DesiredViewMap::serves(const ShadowTask& task)
{
    return !anyHostDrawn(task.casters->all);
}

void DesiredViewMap::declare(PassBuilder& passes, const ShadowTask& task, const LightFit& fit,
                             const gpu::MapConstants& constants, std::uint32_t borderTexels) const
{
    FrameArena& arena = passes.arena();
    const auto resolution = static_cast<std::uint32_t>(constants.map.side);
    gpu::DesiredViewConstants block{.base = constants, .border = static_cast<float>(borderTexels)};
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    block.pixels = {static_cast<std::uint32_t>(pixels.offset.x), static_cast<std::uint32_t>(pixels.offset.y),
                    pixels.extent.width, pixels.extent.height};
    const gpu::DesiredViewConstants* shared = arena.make(block);

    const BufferId view = passes.transient(BufferInfo{.name = "desired_view.view", .size = sizeof(gpu::DesiredView)});
    passes.transfer("desired_view.clear").writes(view).record([=](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(view), 0, VK_WHOLE_SIZE, 0);
    });
    const LookupImages seen(task, task.depth);
    PassRef count = passes.compute("desired_view.seen");
    count.samples(seen.depth).updates(view);
    if (seen.hasNormals) count.samples(seen.normals);
    count.record([=, pipeline = seen_[seen.hasNormals]](PassContext& gpu) {
        const auto groups = [](std::uint32_t side) { return (side + kPixelsPerGroup - 1) / kPixelsPerGroup; };
        if (shared->pixels.z == 0 || shared->pixels.w == 0) return;
        gpu.bind(pipeline, {gpu.constants(0, *shared), gpu.storage(1, view), gpu.sampled(2, seen.depth),
                            gpu.sampled(3, seen.normals)});
        gpu.vk->vkCmdDispatch(gpu.cmd, groups(shared->pixels.z), groups(shared->pixels.w), 1);
    });
    passes.compute("desired_view.crop").updates(view).record([=, pipeline = crop_](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *shared), gpu.storage(1, view)});
        gpu.vk->vkCmdDispatch(gpu.cmd, 1, 1, 1);
    });

    const ImageId map = passes.transient(
        ImageInfo{.name = "desired_view.depth", .format = kMapFormat, .extent = {resolution, resolution}});
    passes.raster("desired_view.casters")
        .reads(view)
        .depthWrite(map, {.clear = true, .value = {.depthStencil = {1.0f, 0}}})
        .record([=, casters = meshesIn(task.casters->all, fit.volume, arena),
                 draw = DepthCasters(casters_, fit, task, resolution, arena)](PassContext& gpu) {
            const Bound bindings[] = {gpu.constants(0, *shared), gpu.storage(1, view)};
            draw.record(gpu, casters, bindings);
        });

    resolve_.declare(passes, task, map, block,
                     {.filtered = constants.map.filterSide > 1.0f, .more = {{{.buffer = view}}}});
}

} // namespace gnomon
