#pragma once
// Depth maps from points of a light's surface: one layer a point, kept for as long as light and casters stand still.
#include <array>
#include <span>

#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "shaders/hybrid/eight_point.h"

namespace gnomon {

inline constexpr std::uint32_t kLightPoints = gpu::LIGHT_POINTS;

/// The points in the unit disc: the centre, and seven around it. They stand for an eighth of the area each: the ring's
/// radius, 2/3 (1 - 8^-3/2) / (1 - 1/8), is the mean distance from the centre of what lies outside of its eighth. Half
/// planes over the disc are then off by 0.048 on average; 0.65 gives 0.053, 0.80 0.052.
std::array<glm::vec2, kLightPoints> lightPoints();

/// The disc of a light seen along its axis; for receivers off it the same points of the disc turned to them.
struct PointDisc {
    glm::vec3 across; ///< Of LightDisc, for all receivers.
    float radius;     ///< discRadius().

    explicit PointDisc(const LightView& light) : across(axisAcross(light.direction())), radius(discRadius(light)) {}
};

/// The light as a point of its disc has it, the disc seen along the axis. A spot light's cone is wider by 1/8 of the
/// distance, so that farther away than eight radii the cone of the light lies inside the cone of every point.
LightView lightFrom(const LightView& light, glm::vec2 point);

/// Declares what is missing of the layers, of kMapFormat and resolution x resolution, and adds to `looks` how the
/// view's receivers are found in each (map_lookup.h). The light is directional or spot.
ImageId declarePointMaps(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, std::span<gpu::MapLookup, kLightPoints> looks);

} // namespace gnomon
