#include "runtime/scene/scene_view.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/scene/long_edges.hpp"

// All tests run in double: differences and products of floats are then exact or nearly so, and "false" needs no margin
// beyond those that stand in the functions.
namespace gnomon {
namespace {

struct Box {
    glm::dvec3 center, half;
};

Box boxOf(const Aabb& box) noexcept
{
    const glm::dvec3 lower(box.lower), upper(box.upper);
    return {0.5 * (lower + upper), 0.5 * (upper - lower)};
}

/// Smallest dot(normal, p) over the box.
double leastAlong(const Box& box, glm::dvec3 normal) noexcept
{
    return glm::dot(normal, box.center) - glm::dot(glm::abs(normal), box.half);
}

bool touchesBall(const Box& box, glm::dvec3 center, double radius) noexcept
{
    const glm::dvec3 beside = glm::max(glm::abs(center - box.center) - box.half, glm::dvec3(0.0));
    return glm::dot(beside, beside) <= radius * radius;
}

/// The box lies on the outer side of a plane that has the whole cone on its other side. Two planes are tried: the one
/// through the apex across the axis, and the one that touches the cone where it is nearest to the box's centre.
/// `reach` widens the cone by that many metres.
bool besideCone(const Box& box, glm::dvec3 apex, glm::dvec3 axis, double halfAngle, double reach) noexcept
{
    const Box local{box.center - apex, box.half};
    if (leastAlong(local, -axis) > reach) return true;
    const glm::dvec3 across = local.center - glm::dot(local.center, axis) * axis;
    const double distance = glm::length(across);
    // The centre is on the axis: what is left of `across` is rounding, 1e-16 of the distance, and points anywhere. From
    // here on it is across to 1e-7, which the slack of reaches() covers.
    if (distance <= 1e-9 * glm::length(local.center)) return false;
    const glm::dvec3 normal = std::cos(halfAngle) * (across / distance) - std::sin(halfAngle) * axis;
    return leastAlong(local, normal) > reach;
}

} // namespace

float cornersOf(std::span<const Caster> casters, const glm::vec3& eye)
{
    float edge = 0.0f, reach = 0.0f;
    for (const Caster& caster : casters) {
        edge = std::max(edge, caster.longestEdge);
        if (caster.meshReach <= reach) continue; // nearly all
        const glm::vec3 away = glm::abs(eye - caster.translation);
        reach = std::max(reach, std::min(caster.meshReach, std::max({away.x, away.y, away.z})));
    }
    return std::max(0.25f * std::min(edge, kLongEdge), 0.5f * reach);
}

bool touches(const Aabb& box, std::span<const Plane> volume)
{
    const Box b = boxOf(box);
    return std::all_of(volume.begin(), volume.end(), [&b](const Plane& plane) {
        const glm::dvec3 normal(plane.normal);
        return -leastAlong(b, -normal) + static_cast<double>(plane.distance) >= 0.0;
    });
}

bool holds(std::span<const Plane> volume, const Aabb& box)
{
    const Box b = boxOf(box);
    return std::all_of(volume.begin(), volume.end(), [&b](const Plane& plane) {
        return leastAlong(b, glm::dvec3(plane.normal)) + static_cast<double>(plane.distance) >= 0.0;
    });
}

bool touches(const Aabb& box, glm::vec3 center, float radius)
{
    return touchesBall(boxOf(box), glm::dvec3(center), radius);
}

// A segment from a source of radius r to a point in range and cone stays within r of "range and cone", since that is
// convex: hence everything is widened by r. The shader decides about cone and range in float, hence the further 1e-6
// of the distance and of the angle (8 ulp).
bool reaches(const LightView& light, const Aabb& box)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return true;
    const Box b = boxOf(box);
    const glm::dvec3 apex(light.position());
    const double radius = light.sourceReach();
    const double range = (static_cast<double>(light.constants.range) + radius) * (1.0 + 1e-6);
    if (!touchesBall(b, apex, range)) return false;
    if (light.type == GN_LIGHT_TYPE_POINT) return true;
    const double slack = 1e-6 * (glm::length(b.center - apex) + glm::length(b.half));
    // Of unit length to 2^-24 only: for a box on the axis what lies across it would else point along it.
    const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction()));
    return !besideCone(b, apex, axis, static_cast<double>(light.coneAngle), radius + slack);
}

bool holdsLight(const Aabb& box, const LightView& light)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return false;
    const glm::vec3 at = light.position();
    return glm::all(glm::greaterThanEqual(at, box.lower)) && glm::all(glm::lessThanEqual(at, box.upper));
}

Aabb transformed(const Aabb& box, const glm::mat3& basis, glm::vec3 translation)
{
    const Box b = boxOf(box);
    Aabb result;
    for (int row = 0; row < 3; ++row) {
        double center = translation[row], half = 0.0, terms = std::abs(center);
        for (int column = 0; column < 3; ++column) {
            const double factor = basis[column][row];
            center += factor * b.center[column];
            half += std::abs(factor) * b.half[column];
            terms += std::abs(factor) * (std::abs(b.center[column]) + b.half[column]);
        }
        // The vertex shader sums these terms in float: at most 6 roundings of 2^-24 each, one more for our own result.
        half += terms * 0x1p-21;
        result.lower[row] = static_cast<float>(center - half);
        result.upper[row] = static_cast<float>(center + half);
    }
    return result;
}

} // namespace gnomon
