#pragma once
// A light with a surface as one receiver sees it: the disc that its sphere turns towards the receiver, or the sun's.
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "runtime/rays/ray_scene.hpp"

namespace gnomon {

/// Radius of the disc over the length of the ray towards its centre (Receivers::at): a directional light's radius is an
/// angle, and its rays are of length 1.
inline float discRadius(const LightView& light)
{
    const float radius = light.constants.sourceRadius;
    return light.type == GN_LIGHT_TYPE_DIRECTIONAL ? std::tan(radius) : radius;
}

/// A sun as wide as this is half of the sky's height; its disc's rim lies at tan = 1.
inline constexpr float kWidestSun = 0.7854f;

/// Why rays cannot go to points of this light's disc, or null.
inline const char* refusesDisc(const LightView& light)
{
    const bool wide = light.type == GN_LIGHT_TYPE_DIRECTIONAL && light.constants.sourceRadius > kWidestSun;
    return wide ? "directional light's sourceRadius above 0.7854 (45 degrees)" : nullptr;
}

/// The world axis along which a direction goes least; the first of equals.
inline glm::vec3 axisAcross(glm::vec3 direction)
{
    const glm::vec3 size = glm::abs(direction);
    if (size.x <= size.y && size.x <= size.z) return {1.0f, 0.0f, 0.0f};
    return size.y <= size.z ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(0.0f, 0.0f, 1.0f);
}

/// The disc's axes, as long as its radius. Two receivers that lie close together have axes that do, if `across` is one
/// vector for both and not along the ray of either.
struct LightDisc {
    glm::vec3 x{0.0f}, y{0.0f};

    LightDisc() = default;
    LightDisc(glm::vec3 towardsLight, glm::vec3 across, float radius)
    {
        y = glm::cross(towardsLight, across);
        x = glm::cross(y, towardsLight);
        // 1e-30: a ray along `across`, or of no length, has the centre alone.
        y *= radius / std::fmax(glm::length(y), 1e-30f);
        x *= radius / std::fmax(glm::length(x), 1e-30f);
    }

    /// The ray to a point of the unit disc. It ends in the plane in which the centre's ray ends, the offset before the
    /// light.
    ShadowRay ray(const ShadowRay& centre, glm::vec2 point) const
    {
        return {centre.origin, centre.tfar, centre.direction + point.x * x + point.y * y};
    }
};

} // namespace gnomon
