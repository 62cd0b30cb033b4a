#pragma once
// From a light's fit to what the shaders need: how casters are drawn into the map and how receivers are looked up.
#include <cstdint>
#include <limits>

#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"
#include "shaders/shared/map_lookup.h"
#include "shaders/shared/shadow_sample.h"

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

/// Moves the near end of a perspective fit as far from the light as depths in a map of `resolution` texels need it, for
/// maps whose casters are clamped to the near end instead of clipped: they still cast on whatever lies beyond, and none
/// is left out of the fit's volume for lying before it. What lies there cannot be told apart: receivers are lit, or
/// undecided (shaders/shared/verdict.glsl).
///
/// The slack DEPTH_ROUNDING is 2^-22 t^2 / near at distance t. A fit takes the near end from the casters' bounds, and
/// where the light hangs inside them that is next to nothing. At the farthest caster, t = end, a texel is s end wide:
/// the slack is an eighth of it with near = 2^-19 / s end, nearer to the light less. That is 1/1000 of the end for 1024
/// texels and a cone of 45 degrees (3 cm at 30 m), and never more than 1/128.
/// @param limit metres; the end is raised no farther. For casters that may be clipped.
void raiseNearEnd(LightFit& fit, std::uint32_t resolution, float limit = std::numeric_limits<float>::infinity());

/// Constants of a resolve pass over a task's view; the projection part is zero.
gpu::MapConstants mapConstants(const ShadowTask& task, std::uint32_t resolution, std::uint32_t filterSide);

/// Adds how the view's receivers are found in the map of one fit.
void addProjection(gpu::MapConstants& constants, const LightFit& fit, const ShadowTask& task);

/// The same for a light of any kind: one fit, or the six of a cube.
void addLightProjection(gpu::MapConstants& constants, std::span<const LightFit> fits, const ShadowTask& task);

/// What hosts' shaders look up in a map like that.
gpu::ShadowSample sampleOf(const gpu::MapLookup& look, std::uint32_t kind);

} // namespace gnomon
