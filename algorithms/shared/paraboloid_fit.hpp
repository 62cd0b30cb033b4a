#pragma once
// Which directions the paraboloids of a light show: two halves of the world, a cone around what is seen, or two skewed
// halves that are densest where the view looks.
#include <array>
#include <cstdint>
#include <span>

#include "algorithms/shared/frusta.hpp"
#include "runtime/algorithm.hpp"
#include "shaders/shared/paraboloid.h"

namespace gnomon {

/// Texels of a map's side that receivers just past its rim and 8 x 8 filters around them have at each end.
inline constexpr float kParaboloidBorderTexels = 5.0f;

/// How much of a map's half side is left for what it shows.
constexpr float innerShare(std::uint32_t resolution)
{
    return 1.0f - 2.0f * kParaboloidBorderTexels / static_cast<float>(resolution);
}

/// What the parts of a light's map show in one frame.
struct ParaboloidSet {
    std::array<gpu::Paraboloid, 2> parts{};
    std::array<std::array<Plane, 4>, 2> volumes{}; ///< Around all that a part shows; planes that are not needed are 0.
    glm::vec3 firstWs{0.0f};   ///< A receiver in direction v is in part 0 where dot(v, firstWs) >= 0, else in part 1.
    std::uint32_t needed = 3;  ///< Bit i: part i is drawn.
    std::uint32_t cutSide = 0; ///< Texels per side of two plain halves whose casters are cut as finely.
    bool followsView = false;  ///< The parts depend on the view: each view has a map of its own.
};

/// A plane through the light around directions v with dot(v, inward) >= -past, for casters at most `reach` away.
inline Plane planeThrough(glm::vec3 light, glm::vec3 inward, float past, float reach)
{
    return {inward, past * reach - glm::dot(inward, light)};
}

/// The lower and the upper half of the world around the light (Navratil 2015, 3.3.2). With MapCulling::parts a half
/// that the view frustum lies beside is not needed (3.3.3).
ParaboloidSet lowerAndUpper(const ShadowTask& task, std::uint32_t resolution, float reach, MapCulling culling);

/// Directions around an axis.
struct Cone {
    glm::vec3 axis{0.0f};
    float cosine = -1.0f; ///< Of the half angle; -1: no cone of less than a right angle holds them all.
};

/// The narrowest cone around unit directions (at most 8).
Cone coneAround(std::span<const glm::vec3> directions);

/// The narrowest cone from the light around the part of the frustum whose depth along the view is within `range` of the
/// light's (Navratil 2015, eqs. 4.1 and 4.2, with the range in place of the visible depths). Without one, the light is
/// inside; cosine 1 and no axis: there is nothing within range.
Cone coneOf(const Frustum& frustum, glm::vec3 light, float range);

/// Radius on the disc of what lies at an angle with that cosine from the axis: tan(angle / 2).
inline float discRadius(float cosine)
{
    return glm::sqrt(glm::max(1.0f - cosine, 0.0f) / (1.0f + cosine));
}

/// One paraboloid cut to the cone, half angle below a right angle (Navratil 2015, 4.1.2). It needs a map per view.
ParaboloidSet cutToCone(const ShadowTask& task, const Cone& cone, std::uint32_t resolution, float reach);

/// The direction from the light to where the view looks: a point on its axis, half as far from the eye as the light, in
/// steps of about 4 degrees, so that a map outlives small movements of the camera.
glm::vec3 beforeTheEye(const CameraView& view, glm::vec3 light);

/// A unit vector at right angles, the same for the same axis.
glm::vec3 beside(glm::vec3 axis);

/// Two halves whose rims are densest towards `dense` (Navratil 2015, 4.1.4): both axes lean away from it by `skew`
/// radians, and each map shows the disc that its hemisphere is seen as.
/// @param pole unit, at right angles to `dense`, which is unit: middle of the first hemisphere
ParaboloidSet skewedHalves(const ShadowTask& task, glm::vec3 pole, glm::vec3 dense, float skew,
                           std::uint32_t resolution, float reach, MapCulling culling);

} // namespace gnomon
