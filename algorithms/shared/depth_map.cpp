#include "algorithms/shared/depth_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "shaders/shared_depth_map_vert.h"

namespace gnomon {

GraphicsPipelineInfo depthCasterPipeline(const AlgorithmServices& services)
{
    GraphicsPipelineInfo info;
    info.name = "depth_map.casters";
    info.vertex.code = k_shared_depth_map_vert;
    info.pushBytes = sizeof(DepthCasters::Push);
    info.vertexStride = sizeof(glm::vec3);
    info.casters = info.transforms = true;
    info.depthTest = info.depthWrite = true;
    info.depthCompare = VK_COMPARE_OP_LESS;
    info.depthFormat = kMapFormat;
    info.depthClamp = services.vk->enabled.depthClamp == VK_TRUE;
    return info;
}

DepthMapPipelines makeDepthMapPipelines(const AlgorithmServices& services)
{
    const GraphicsPipelineInfo info = depthCasterPipeline(services);
    return {services.pipelines->graphics(info), info.depthClamp ? Clamped::own : Clamped::none};
}

DepthCasters::DepthCasters(const DepthMapPipelines& pipelines, const LightFit& fit, const ShadowTask& task,
                           std::uint32_t resolution, FrameArena& arena, std::span<const Plane> volume)
    : pipeline_(pipelines.casters), light_(task.light), volume_(volume)
{
    push_ = casterPush(mapProjection(fit, *task.light));
    if (!anyHostDrawn(task.casters->all)) return;
    GnCasterProjection host{};
    std::memcpy(host.clipFromWorld, &fit.clipFromWorld, sizeof(host.clipFromWorld));
    std::memcpy(host.origin, task.view->origin, sizeof(host.origin));
    host.area = {{0, 0}, {resolution, resolution}};
    host.depthFormat = kMapFormat;
    host.slopeBias = kOpenSlopeBias;
    host_ = arena.make(host);
}

void DepthCasters::record(PassContext& gpu, std::span<const Caster* const> casters,
                          std::span<const Bound> bindings) const
{
    drawInParts(*light_, casters, [&](std::span<const Caster* const> run, const DrawnPart& part) {
        const Push push = moved(push_, part.away);
        gpu.drawCasters({.pipeline = pipeline_,
                         .casters = run,
                         .volume = volume_,
                         .bindings = bindings,
                         .push = &push,
                         .pushSize = sizeof(push),
                         .depthFromOne = fromOne(push),
                         .firstFace = part.firstFace,
                         .faceCount = part.faceCount,
                         .hostProjection = host_});
    });
}

Cells DepthCasters::cells(std::span<const Caster* const> casters) const
{
    Cells covered = 0;
    for (const Caster* caster : casters)
        covered |= boxCells(caster->bounds, push_.clipFromZero, glm::vec3(push_.zeroWs));
    return covered;
}

float nearLimit(Clamped clamped, const ShadowTask& task)
{
    float nearest = std::numeric_limits<float>::infinity();
    if (clamped == Clamped::all) return nearest;
    for (const Caster* caster : task.casters->all)
        if (caster->hostDrawn) nearest = std::min(nearest, nearestDepth(*task.light, caster->bounds));
    return nearest > 0.0f && std::isfinite(nearest) ? std::exp2(std::floor(std::log2(nearest))) : nearest;
}

namespace {

/// A directional map with an empty border.
LightFit withBorder(const LightFit& fit, std::uint32_t resolution, std::uint32_t borderTexels)
{
    const glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clipFromWorld));
    const double inner = 1.0 - std::min(2.0 * borderTexels / resolution, 0.5); // as runtime/scene/light_fit.cpp
    glm::dvec2 middle, half;
    for (int axis = 0; axis < 2; ++axis) {
        const double scale = glm::length(glm::dvec3(rows[axis]));
        middle[axis] = -rows[axis].w / scale;
        half[axis] = 1.0 / (scale * inner);
    }
    return fitWindow(fit, middle, half);
}

} // namespace

LightFit* fitDepthMap(Clamped clamped, const ShadowTask& task, std::uint32_t resolution, FrameArena& arena,
                      std::uint32_t borderTexels)
{
    const Aabb bounds = sceneBounds(*task.casters);
    const bool spot = task.light->type == GN_LIGHT_TYPE_SPOT;
    LightFit* fit = arena.make(spot ? fitSpot(*task.light, bounds, resolution, static_cast<float>(borderTexels))
                                    : fitDirectional(*task.light, bounds));
    if (!spot && borderForm(borderTexels) != 0) *fit = withBorder(*fit, resolution, borderTexels);
    if (spot && clamped != Clamped::none) raiseNearEnd(*fit, resolution, nearLimit(clamped, task));
    return fit;
}

namespace {

DepthMap declareFitted(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                       const LightFit* fit, const ViewMapNames& names, const KeptMapInfo& info)
{
    FrameArena& arena = passes.arena();
    KeptMap map(passes, info);
    const std::uint64_t projection = Stamp().add(fit->clipFromWorld).value();
    const LayerContent content = layerContent(*task.light, castersIn(task.casters->statics, fit->volume, arena),
                                              castersIn(task.casters->dynamics, fit->volume, arena), projection);
    const KeptParts parts =
        map.update(0, names.passes, content, DepthCasters(pipelines, *fit, task, info.resolution, arena));
    return {map.image(), fit, info.resolution, content.stamp, parts};
}

KeptMapInfo infoOf(const ViewMapNames& names, std::uint32_t resolution)
{
    return {.name = names.depth,
            .staticsName = names.statics,
            .stampName = names.stamp,
            .format = kMapFormat,
            .resolution = resolution};
}

} // namespace

DepthMap declareDepthMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, std::uint32_t borderTexels)
{
    static constexpr ViewMapNames kNames{"depth_map.depth",
                                         "depth_map.statics",
                                         "depth_map.stamp",
                                         {"depth_map.casters", "depth_map.statics", "depth_map.copy_statics"}};
    const LightFit* fit = fitDepthMap(pipelines.clamped, task, resolution, passes.arena(), borderTexels);
    KeptMapInfo info = infoOf(kNames, resolution);
    info.form = borderForm(borderTexels);
    return declareFitted(passes, pipelines, task, fit, kNames, info);
}

DepthMap declareViewMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                        std::uint32_t resolution, const LightFit* fit, const ViewMapNames& names)
{
    KeptMapInfo info = infoOf(names, resolution);
    info.scope = Scope::task;
    return declareFitted(passes, pipelines, task, fit, names, info);
}

VkDeviceSize depthMapMemory(std::uint32_t resolution, std::uint32_t layers)
{
    return VkDeviceSize{resolution} * resolution * layers * 4 * 2;
}

VkDeviceSize lightMapMemory(std::span<const double> settings, VkExtent2D, GnLightType type)
{
    return depthMapMemory(static_cast<std::uint32_t>(settings[0]), mapLayers(type));
}

} // namespace gnomon
