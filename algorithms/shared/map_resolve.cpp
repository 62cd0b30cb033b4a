#include "algorithms/shared/map_resolve.hpp"

#include <algorithm>

#include "runtime/scene/light_pixels.hpp"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

std::array<BindingInfo, 4> lookupBindings(bool layers)
{
    return {{constantsAt(0),
             sampledAt(2, VK_FORMAT_D32_SFLOAT),
             sampledAt(3, VK_FORMAT_R16G16B16A16_SFLOAT),
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
    uses.writes(target, part).area(drawnArea(view));
}

MapResolve::MapResolve(const AlgorithmServices& services, const MapResolveInfo& info)
    : name_(info.name), more_(info.more), sampler_(info.sampler), hasCube_(!info.cube.empty())
{
    GraphicsPipelineInfo pipeline;
    pipeline.name = info.name;
    pipeline.vertex.code = k_shared_map_resolve_vert;
    pipeline.fragment.specializationCount = 3;
    pipeline.colorFormat = info.format;
    for (const bool cube : {false, true}) {
        if (cube && !hasCube_) continue;
        const std::array lookup = lookupBindings(cube || info.layers);
        std::array<BindingInfo, lookup.size() + Lookup::kMostMore> bindings{};
        std::ranges::copy(lookup, bindings.begin());
        std::ranges::copy(info.more, bindings.begin() + lookup.size());
        bindings[lookup.size() - 1].sampler = info.sampler;
        for (BindingInfo& binding : bindings)
            binding.array = binding.array || (binding.powerOfTwo && bindings[lookup.size() - 1].array);
        pipeline.bindings = std::span(bindings).first(lookup.size() + info.more.size());
        pipeline.fragment.code = cube ? info.cube : info.fragment;
        pipeline.fragment.specialization[2] = cube;
        for (const bool normals : {false, true}) {
            for (const bool filtered : {false, true}) {
                pipeline.fragment.specialization[0] = normals;
                pipeline.fragment.specialization[1] = info.filters && filtered;
                pipelines_[cube][normals][filtered] = services.pipelines->graphics(pipeline); // equal ones are one
            }
        }
    }
}

LookupPass MapResolve::passOf(PassBuilder& passes, const ShadowTask& task, const LookupImages& look,
                              const Lookup& lookup) const
{
    LookupPass pass = lookup.target ? LookupPass(passes, task, name_, look, lookup.target, lookup.otherwise)
                                    : LookupPass(passes, task, name_, look);
    for (const Lookup::Input& input : std::span(lookup.more).first(more_.size())) {
        if (!input.image)
            pass.uses.reads(input.buffer);
        else if (&input == lookup.more.data() || input.image.index != lookup.more.front().image.index)
            pass.uses.samples(input.image);
    }
    return pass;
}

std::uint32_t filterSide(double setting)
{
    return static_cast<std::uint32_t>(setting) | 1u;
}

} // namespace gnomon
