#include "algorithms/shared/map_resolve.hpp"

#include "runtime/scene/light_pixels.hpp"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

std::array<BindingInfo, 4> lookupBindings(bool layers)
{
    return {{{.binding = 0, .kind = BindingKind::constants},
             {.binding = 2, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT},
             {.binding = 3, .kind = BindingKind::sampledImage, .format = VK_FORMAT_R16G16B16A16_SFLOAT},
             {.binding = 4,
              .kind = BindingKind::sampledImage,
              .format = kMapFormat,
              .array = layers,
              .sampler = SamplerKind::nearestBorderFar,
              .powerOfTwo = true}}};
}

LookupImages::LookupImages(const ShadowTask& task, ImageId mapImage)
    : depth(task.depth), normals(task.normals ? task.normals : task.depth), map(mapImage),
      hasNormals(static_cast<bool>(task.normals))
{
}

void LookupImages::uses(PassRef& pass) const
{
    pass.samples(depth).samples(map);
    if (hasNormals) pass.samples(normals);
}

LookupPass::LookupPass(PassBuilder& passes, const ShadowTask& task, const char* name, const LookupImages& look)
    : uses(passes.raster(name)), pixels_(lightPixels(*task.light, *task.view))
{
    look.uses(uses);
    writes(*task.view, task.visibility, visibilityIn(*task.view, task.layer, pixels_));
}

LookupPass::LookupPass(PassBuilder& passes, const ShadowTask& task, const char* name, const LookupImages& look,
                       ImageId target, VkClearValue otherwise)
    : uses(passes.raster(name)), pixels_(lightPixels(*task.light, *task.view))
{
    look.uses(uses);
    writes(*task.view, target, {.clear = true, .value = otherwise});
}

void LookupPass::writes(const CameraView& view, ImageId target, const Part& part)
{
    const VkRect2D& area = view.area;
    uses.writes(target, part).area({area.offset.x, area.offset.y, area.extent.width, area.extent.height});
}

MapResolve::MapResolve(const AlgorithmServices& services, const MapResolveInfo& info) : info_(info)
{
    const std::array bindings = lookupBindings(info.layers);
    GraphicsPipelineInfo pipeline;
    pipeline.name = info.name;
    pipeline.vertex.code = k_shared_map_resolve_vert;
    pipeline.fragment.code = info.fragment;
    pipeline.fragment.specializationCount = info.filters ? 2 : 1;
    pipeline.bindings = bindings;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    for (std::uint32_t normals = 0; normals < 2; ++normals) {
        for (std::uint32_t filtered = 0; filtered < 2; ++filtered) {
            pipeline.fragment.specialization[0] = normals;
            pipeline.fragment.specialization[1] = info.filters ? filtered : 0;
            pipelines_[normals][filtered] = services.pipelines->graphics(pipeline); // equal ones are one
        }
    }
}

std::uint32_t filterSide(double setting)
{
    return static_cast<std::uint32_t>(setting) | 1u;
}

} // namespace gnomon
