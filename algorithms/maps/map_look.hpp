#pragma once
// From a light's fit to what the shaders need: how casters are drawn into the map and how receivers are looked up.
#include <cstdint>

#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"
#include "shaders/maps/map_look.h"

namespace gnomon {

/// LightFit::clipFromWorld about a zero of its own: the light, where there is one. Rounding of a far translation would
/// otherwise be multiplied by distance / near in the depths.
struct MapProjection {
    glm::mat4 clipFromZero{1.0f};
    glm::vec3 zeroWs{0.0f};
    float depthConstant = 0.0f; ///< Perspective: depth = depthConstant + depthScale / clip w. Directional: 0, -1.
    float depthScale = -1.0f;
};
MapProjection mapProjection(const LightFit& fit, const LightView& light);

/// Moves the near end of a perspective fit away from the light, to 1/128 of the distance at which the farthest caster
/// can be, for maps whose casters are clamped to the near end instead of clipped: they still cast on whatever lies
/// beyond.
///
/// Depth at distance t resolves 2^-24 t^2 / near. A fit takes the near end from the casters' bounds, and where the
/// light hangs inside them that is nothing: 30 m away depths would be 2 cm apart, now 10 micrometres.
void raiseNearEnd(LightFit& fit, const LightView& light, const Aabb& scene);

/// Constants of a resolve pass over a task's view; the projection part is zero.
gpu::MapConstants mapConstants(const ShadowTask& task, std::uint32_t resolution, std::uint32_t filterSide);

/// Adds how the view's receivers are found in the map of one fit.
void addProjection(gpu::MapConstants& constants, const LightFit& fit, const ShadowTask& task);

/// The same for a light of any kind: one fit, or the six of a cube.
void addLightProjection(gpu::MapConstants& constants, std::span<const LightFit> fits, const ShadowTask& task);

} // namespace gnomon
