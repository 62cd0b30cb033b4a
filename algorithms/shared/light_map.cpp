#include "algorithms/shared/light_map.hpp"

#include "algorithms/shared/cube_faces.hpp"
#include "algorithms/shared/trapezoid.hpp"

namespace gnomon {

std::span<const LightFit> fitLightMap(Clamped clamped, const ShadowTask& task, std::uint32_t resolution,
                                      FrameArena& arena)
{
    if (task.light->type == GN_LIGHT_TYPE_POINT) return fitCubeFaces(clamped, task, resolution, arena);
    return {fitDepthMap(clamped, task, resolution, arena), 1};
}

std::uint32_t neededLayers(const ShadowTask& task)
{
    return task.light->type == GN_LIGHT_TYPE_POINT ? neededCubeFaces(task) : 1;
}

DepthMap declareSeenMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                        std::uint32_t resolution, std::uint32_t borderTexels)
{
    static constexpr ViewMapNames kNames{"seen_map.depth",
                                         "seen_map.statics",
                                         "seen_map.stamp",
                                         {"seen_map.casters", "seen_map.statics", "seen_map.copy_statics"}};
    const LightFit* fit = fitSeenMap(pipelines.clamped, task, resolution, passes.arena(), borderTexels);
    return declareViewMap(passes, pipelines, task, resolution, fit, kNames);
}

LightMap declareLightMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, gpu::MapConstants& constants, std::uint32_t borderTexels, MapFit fit)
{
    LightMap result;
    if (task.light->type != GN_LIGHT_TYPE_POINT) {
        const bool seen = fit == MapFit::seen;
        const DepthMap map =
            (seen ? declareSeenMap : declareDepthMap)(passes, pipelines, task, resolution, borderTexels);
        FrameArena& arena = passes.arena();
        result = {map.image, {map.fit, 1}, 1, {arena.make(map.stamp), 1}, {arena.make(map.parts), 1}};
        if (seen) result.scope = Scope::task;
    } else {
        const CubeMap map = declareCubeMap(passes, pipelines, task, resolution, borderTexels);
        result = {map.image, {map.faces, 6}, map.needed, {map.stamps, 6}, {map.parts, 6}};
    }
    addLightProjection(constants, result.fits, task);
    return result;
}

ShadowAlgorithm::Map handedOut(ImageId image, std::span<const LightFit> fits, std::uint32_t validLayers,
                               const gpu::MapConstants& constants)
{
    ShadowAlgorithm::Map map{.image = image,
                             .clipFromWorld = {},
                             .validLayers = validLayers,
                             .sample =
                                 sampleOf(constants.map, fits.size() == 1 ? gpu::SAMPLE_MATRIX : gpu::SAMPLE_CUBE)};
    for (std::size_t i = 0; i < fits.size(); ++i)
        map.clipFromWorld[i] = fits[i].clipFromWorld;
    return map;
}

} // namespace gnomon
