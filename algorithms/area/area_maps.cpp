#include "algorithms/area/area_maps.hpp"

#include <algorithm>
#include <array>

#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/trapezoid.hpp"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

float nearestCaster(const ShadowTask& task)
{
    double nearest = 1e18;
    for (const Caster* caster : task.casters->all)
        nearest = std::min(nearest, nearestDistance(caster->bounds, glm::dvec3(task.light->position())));
    return static_cast<float>(nearest);
}

gpu::MapConstants centreConstants(const ShadowTask& task, std::uint32_t resolution)
{
    gpu::MapConstants constants = mapConstants(task, resolution, 1);
    if (task.light->type == GN_LIGHT_TYPE_DIRECTIONAL) constants.map.axisWs = glm::vec4(task.light->direction(), 0.0f);
    return constants;
}

gpu::MapLookup declarePointMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                               const PointMap& map)
{
    FrameArena& arena = passes.arena();
    const LightFit& fit = map.seen ? *fitSeenMap(pipelines.clamped, task, map.resolution, arena)
                                   : *fitDepthMap(pipelines.clamped, task, map.resolution, arena);
    gpu::MapConstants look = mapConstants(task, map.resolution, 1);
    addProjection(look, fit, task);
    if (!map.due) return look.map;
    const DepthCasters draw(pipelines, fit, task, map.resolution, arena);
    PassRef pass = passes.raster(map.name, map.scope, map.variant);
    pass.depthWrite(map.image, {.layer = map.layer, .clear = true, .value = {.depthStencil = {1.0f, 0}}});
    if (map.after) pass.reads(map.after);
    draw.uses(pass);
    pass.record([draw, skipped = map.skipped, statics = castersIn(task.casters->statics, fit.volume, arena),
                 dynamics = castersIn(task.casters->dynamics, fit.volume, arena)](PassContext& gpu) {
        if (skipped && *skipped) return;
        draw(gpu, statics, true);
        draw(gpu, dynamics, false);
    });
    return look.map;
}

PointLookups makePointLookups(const AlgorithmServices& services, const char* name,
                              std::span<const std::uint32_t> fragment, VkFormat format, bool sums, bool blend)
{
    std::array<BindingInfo, 5> bindings{};
    const std::array lookup = lookupBindings(true);
    std::copy(lookup.begin(), lookup.end(), bindings.begin());
    bindings[4] = sampledAt(5, VK_FORMAT_R16_SFLOAT);
    GraphicsPipelineInfo info{.name = name,
                              .vertex = {.code = k_shared_map_resolve_vert},
                              .fragment = {.code = fragment, .specializationCount = 1},
                              .bindings = std::span(bindings).first(sums ? 5 : 4),
                              .blendScale = blend,
                              .colorFormat = format};
    PointLookups result;
    for (std::uint32_t normals = 0; normals < 2; ++normals) {
        info.fragment.specialization[0] = normals;
        result.of[normals] = services.pipelines->graphics(info);
    }
    return result;
}

} // namespace gnomon
