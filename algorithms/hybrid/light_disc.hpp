#pragma once
// Rays of one receiver to the disc of a light with a surface.
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "algorithms/shared/source_points.hpp"
#include "algorithms/shared/source_size.hpp"
#include "runtime/rays/ray_scene.hpp"

namespace gnomon {

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
