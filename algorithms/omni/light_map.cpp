#include "algorithms/omni/light_map.hpp"

#include "algorithms/omni/cube_faces.hpp"

namespace gnomon {

LightMap declareLightMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, gpu::MapConstants& constants)
{
    if (task.light->type != GN_LIGHT_TYPE_POINT) {
        const DepthMap map = declareDepthMap(passes, pipelines, task, resolution);
        addProjection(constants, *map.fit, task);
        std::uint64_t* stamp = passes.arena().make(map.stamp);
        return {map.image, {map.fit, 1}, 1, {stamp, 1}};
    }
    const CubeMap map = declareCubeMap(passes, pipelines, task, resolution);
    const MapProjection face = mapProjection(map.faces[0], *task.light); // all six differ in their axes only
    constants.map.depthConstant = face.depthConstant;
    constants.map.depthScale = face.depthScale;
    constants.map.slope = 0.5f * map.faces[0].texelAtOne;
    return {map.image, {map.faces, 6}, map.needed, {map.stamps, 6}};
}

} // namespace gnomon
