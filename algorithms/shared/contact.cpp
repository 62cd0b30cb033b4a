#include "algorithms/shared/contact.hpp"

#include "runtime/scene/light_pixels.hpp"
#include "shaders/shared/contact.h"
#include "shaders/shared_contact_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

ContactShadows::ContactShadows(const AlgorithmServices& services)
{
    const BindingInfo bindings[] = {constantsAt(0), sampledAt(2, VK_FORMAT_D32_SFLOAT),
                                    sampledAt(3, VK_FORMAT_R16G16B16A16_SFLOAT)};
    for (const bool normals : {false, true})
        march_[normals] = services.pipelines->graphics({.name = "contact.march",
                                                        .vertex = {.code = k_shared_fullscreen_vert},
                                                        .fragment = {k_shared_contact_frag, 1, {normals}},
                                                        .bindings = bindings,
                                                        .colorFormat = VK_FORMAT_R8_UNORM});
}

void ContactShadows::declare(PassBuilder& passes, const ShadowTask& task, double lengthWs) const
{
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    if (!(lengthWs > 0.0) || pixels.extent.width == 0) return;
    const VkRect2D& area = task.view->area;
    gpu::ContactConstants& constants = *passes.arena().make<gpu::ContactConstants>();
    constants.view = task.view->constants;
    constants.light = task.light->constants;
    constants.area = {static_cast<float>(area.offset.x), static_cast<float>(area.offset.y),
                      static_cast<float>(area.extent.width), static_cast<float>(area.extent.height)};
    constants.lengthWs = static_cast<float>(lengthWs);
    const bool hasNormals = static_cast<bool>(task.normals);
    const ImageId depth = task.depth, normals = hasNormals ? task.normals : task.depth;
    PassRef pass = passes.raster("contact.march");
    pass.samples(depth);
    if (hasNormals) pass.samples(normals);
    pass.writes(task.visibility, {.layer = task.layer, .blend = true})
        .area(drawnArea(*task.view))
        .record([=, block = &constants, pipeline = march_[hasNormals]](PassContext& gpu) {
            gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
            gpu.bind(pipeline, {gpu.constants(0, *block), gpu.sampled(2, depth), gpu.sampled(3, normals)});
            gpu.drawFullscreen();
        });
}

} // namespace gnomon
