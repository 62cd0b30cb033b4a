#include "algorithms/hybrid/device_trace.hpp"

#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid_undecided_vert.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

const char* refusesDeviceRays(const ShadowTask& task)
{
    return task.casters->opacities > 0 ? "casters in range are alpha-tested by pfnOpacity, which the device cannot call"
                                       : nullptr;
}

gpu::RayQueryConstants rayConstants(const ShadowTask& task, std::uint8_t lit, std::uint8_t dark)
{
    const Rect area = drawnArea(*task.view);
    return {.view = task.view->constants,
            .light = task.light->constants,
            .area = {area.x, area.y, area.width, area.height},
            .lightMask = {task.light->mask, lit, dark, 0}};
}

DeviceTrace::DeviceTrace(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> fragment,
                         VkFormat target, Asks asks)
    : name_(name)
{
    const bool listed = asks == Asks::listed;
    const BindingInfo bindings[] = {constantsAt(0),
                                    sampledAt(2, VK_FORMAT_D32_SFLOAT),
                                    sampledAt(3, VK_FORMAT_R16G16B16A16_SFLOAT),
                                    {.binding = 4, .kind = BindingKind::structure},
                                    bufferAt(5),
                                    bufferAt(6)};
    for (const bool normals : {false, true})
        pipelines_[normals] = services.pipelines->graphics(
            {.name = name,
             .vertex = {.code = listed ? std::span<const std::uint32_t>(k_hybrid_undecided_vert)
                                       : std::span<const std::uint32_t>(k_shared_fullscreen_vert)},
             .fragment = {fragment, 1, {normals}},
             .bindings = std::span(bindings).first(listed ? 6 : 5),
             .topology = listed ? VK_PRIMITIVE_TOPOLOGY_POINT_LIST : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
             .colorFormat = target});
}

DeviceTrace::Pixels::Pixels(const ShadowTask& task, BufferId listed)
    : depth(task.depth), normals(task.normals ? task.normals : task.depth), hasNormals(static_cast<bool>(task.normals)),
      scene(*task.rays), list(listed), reached(lightPixels(*task.light, *task.view))
{
}

PassRef DeviceTrace::open(PassBuilder& passes, const ShadowTask& task, ImageId target, const Part& part,
                          BufferId list) const
{
    PassRef pass = passes.raster(name_);
    pass.samples(task.depth).traces(task.rays->order).reads(task.rays->casters);
    if (task.normals) pass.samples(task.normals);
    if (list) pass.reads(list).indirect(list);
    pass.writes(target, part).area(drawnArea(*task.view));
    return pass;
}

void DeviceTrace::draw(PassContext& gpu, const Pixels& pixels, PipelineId pipeline, const Bound& constants)
{
    if (!gpu.clipTo(pixels.reached)) return;
    const Bound bindings[] = {constants,
                              gpu.sampled(2, pixels.depth),
                              gpu.sampled(3, pixels.normals),
                              gpu.structure(4, pixels.scene.topLevel),
                              gpu.storage(5, pixels.scene.casters),
                              pixels.list ? gpu.storage(6, pixels.list) : Bound{}};
    gpu.bind(pipeline, std::span(bindings).first(pixels.list ? 6 : 5));
    if (pixels.list)
        gpu.vk->vkCmdDrawIndirect(gpu.cmd, gpu.buffer(pixels.list), 0, 1, sizeof(VkDrawIndirectCommand));
    else
        gpu.drawFullscreen();
}

} // namespace gnomon
