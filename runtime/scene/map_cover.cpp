#include "runtime/scene/map_cover.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "runtime/scene/light_fit.hpp"

namespace gnomon {

namespace {

// Diagonals from which a box is taken for a flat one in its middle. Of 20 000 boxes that far away, sides of 1 to 20,
// half are off by less than 2 %, 95 % by less than 10; a rod that points at the light by two fifths.
constexpr float kFar = 2.0f;

/// Of the light, which `box` is relative to.
bool isInside(const Aabb& box)
{
    return glm::all(glm::lessThan(box.lower, glm::vec3(0.0f))) &&
           glm::all(glm::greaterThan(box.upper, glm::vec3(0.0f)));
}

/// What a box's shadow on a plane across the direction measures, square metres.
float shadowArea(const Aabb& box, glm::vec3 direction)
{
    const glm::vec3 size = box.upper - box.lower;
    return glm::dot(glm::abs(direction), glm::vec3(size.y * size.z, size.z * size.x, size.x * size.y));
}

/// Solid angle of the rectangle from (0, 0) to (x, y) at distance z.
float cornerAngle(float x, float y, float z)
{
    return std::atan2(x * y, z * std::sqrt(x * x + y * y + z * z));
}

/// Solid angle of a box as seen from the origin, steradians.
float solidAngle(const Aabb& box)
{
    const glm::vec3 centre = 0.5f * (box.lower + box.upper), size = box.upper - box.lower;
    const float away2 = glm::dot(centre, centre);
    if (away2 > kFar * kFar * glm::dot(size, size)) return shadowArea(box, centre / std::sqrt(away2)) / away2;
    if (isInside(box)) return 4.0f * std::numbers::pi_v<float>;
    float sides = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const float at : {box.lower[axis], box.upper[axis]}) {
            const float z = std::max(std::fabs(at), 1e-6f);
            sides += std::fabs(cornerAngle(box.upper[u], box.upper[v], z) - cornerAngle(box.lower[u], box.upper[v], z) -
                               cornerAngle(box.upper[u], box.lower[v], z) + cornerAngle(box.lower[u], box.lower[v], z));
        }
    }
    return 0.5f * sides; // the near sides and the far ones fill the same
}

/// Share of a box that the cone lights, by the circle around it. The box is relative to the light.
float shareInCone(const Aabb& box, glm::vec3 direction, float coneAngle)
{
    const glm::vec3 centre = 0.5f * (box.lower + box.upper);
    const float radius = 0.5f * glm::distance(box.lower, box.upper), away = glm::length(centre);
    if (away <= radius) return 1.0f;
    const float size = std::max(std::asin(radius / away), 1e-6f); // a caster may be a point
    const float off = std::acos(std::clamp(glm::dot(centre, direction) / away, -1.0f, 1.0f));
    return std::clamp((coneAngle + size - off) / (2.0f * size), 0.0f, 1.0f);
}

/// What all maps of the light show: steradians; of a directional light square metres.
float extentOf(const LightView& light, const LightCasters& casters)
{
    constexpr float sphere = 4.0f * std::numbers::pi_v<float>;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return shadowArea(sceneBounds(casters), light.direction());
    if (light.type == GN_LIGHT_TYPE_POINT) return sphere;
    const float slope = std::tan(std::min(light.coneAngle, 1.5f));
    return std::min(4.0f * slope * slope, sphere);
}

/// Bit i: the box, relative to the light, touches face i of the cube, in the order +X -X +Y -Y +Z -Z.
std::uint32_t facesTouched(const Aabb& box)
{
    // What of the box is nearest to each axis.
    const glm::vec3 least = glm::max(glm::max(box.lower, -box.upper), glm::vec3(0.0f));
    std::uint32_t faces = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float others = std::max(least[(axis + 1) % 3], least[(axis + 2) % 3]);
        if (box.upper[axis] >= others) faces |= 1u << (2 * axis);
        if (-box.lower[axis] >= others) faces |= 2u << (2 * axis);
    }
    return faces;
}

} // namespace

MapCover mapCover(const LightView& light, const LightCasters& casters, std::span<const Caster* const> drawn)
{
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const bool spot = light.type == GN_LIGHT_TYPE_SPOT, point = light.type == GN_LIGHT_TYPE_POINT;
    const double all = std::max(double{extentOf(light, casters)}, 1e-12);
    MapCover cover;
    std::uint32_t faces = 0;
    for (const Caster* caster : drawn) {
        const Aabb box{caster->bounds.lower - light.position(), caster->bounds.upper - light.position()};
        const float lit = spot ? shareInCone(box, light.direction(), light.coneAngle) : 1.0f;
        const float extent = directional ? shadowArea(caster->bounds, light.direction()) : lit * solidAngle(box);
        cover.filled += std::min(double{extent} / all, 1.0);
        if (point) faces |= facesTouched(box);
    }
    cover.touched = point ? std::popcount(faces) / 6.0 : drawn.empty() ? 0.0 : 1.0;
    return cover;
}

} // namespace gnomon
