#include "algorithms/hybrid/point_maps.hpp"

#include <cmath>
#include <numbers>

#include "algorithms/shared/depth_casters.hpp"

namespace gnomon {

namespace {

constexpr LayerNames kNames{"point_maps.casters", "point_maps.statics", "point_maps.copy_statics"}; // of all points

} // namespace

std::array<glm::vec2, kLightPoints> lightPoints()
{
    constexpr float ring = 0.7283f;
    std::array<glm::vec2, kLightPoints> points{};
    for (std::uint32_t i = 1; i < kLightPoints; ++i) {
        const float angle =
            2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kLightPoints - 1);
        points[i] = ring * glm::vec2(std::cos(angle), std::sin(angle));
    }
    return points;
}

LightView lightFrom(const LightView& light, glm::vec2 point)
{
    const PointDisc own(light);
    const LightDisc disc(-light.direction(), own.across, own.radius);
    const glm::vec3 moved = point.x * disc.x + point.y * disc.y;
    LightView result = light;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        const glm::vec3 direction = glm::normalize(light.direction() - moved);
        result.constants.directionWs = glm::vec4(direction, light.constants.directionWs.w);
        return result;
    }
    result.constants.positionWs += glm::vec4(moved, 0.0f);
    result.coneAngle = std::atan(std::tan(light.coneAngle) + 1.0f / 8.0f);
    if (!light.unlimited()) result.constants.range += own.radius;
    return result;
}

ImageId declarePointMaps(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, std::span<gpu::MapLookup, kLightPoints> looks)
{
    FrameArena& arena = passes.arena();
    KeptMap map(passes, {.name = "point_maps.depth",
                         .staticsName = "point_maps.statics",
                         .stampName = "point_maps.stamp",
                         .format = kMapFormat,
                         .resolution = resolution,
                         .layers = kLightPoints});
    const std::array points = lightPoints();
    for (std::uint32_t i = 0; i < kLightPoints; ++i) {
        ShadowTask from = task;
        from.light = arena.make(lightFrom(*task.light, points[i])); // casters are drawn by it later in the frame
        const LightFit& fit = *fitDepthMap(pipelines.clamped, from, resolution, arena);
        const LayerContent content =
            layerContent(*task.light, castersIn(task.casters->statics, fit.volume, arena),
                         castersIn(task.casters->dynamics, fit.volume, arena), Stamp().add(fit.clipFromWorld).value());
        map.update(i, kNames, content, DepthCasters(pipelines, fit, from, resolution, arena));
        gpu::MapConstants constants = mapConstants(from, resolution, 1);
        addProjection(constants, fit, from);
        looks[i] = constants.map;
    }
    return map.image();
}

} // namespace gnomon
