#include "runtime/scene/light_fit.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

// Everything is computed in double and rounded once.
namespace gnomon {
namespace {

// Smallest near end in parts of the far end of what is there. Depth in a D32 map resolves 2^-24 z^2 / near at distance
// z: with 1e-4 that is 0.6 mm for 1 m at z = 1 m, below the texel of a 1024 map (2 mm), and near is 0.1 mm.
constexpr double kNearPerFar = 1e-4;
// And no more than this, metres: casters may reach the horizon of a lamp of unlimited range, and shadows near it count.
// What receivers allow for, 2^-22 z^2 / near, is then a texel of a 1024 map, 2 mm a metre, some 800 m away.
constexpr double kMostNearWs = 0.1;
// Room beyond the far end and around a directional fit, for the rounding of matrices and bounds to float.
constexpr double kRoom = 1.0 / 1024.0;

/// Columns of the rotation world -> light: right, down, forward; right x down = forward, so nothing is mirrored.
struct Axes {
    glm::dvec3 right, down, forward;
};

Axes axesAlong(glm::dvec3 forward)
{
    const glm::dvec3 size = glm::abs(forward);
    // The world axis least along `forward`; the first of equals, so that the choice is the same everywhere.
    glm::dvec3 helper(0.0);
    if (size.y <= size.x && size.y <= size.z)
        helper.y = 1.0;
    else if (size.x <= size.z)
        helper.x = 1.0;
    else
        helper.z = 1.0;
    const glm::dvec3 right = glm::normalize(glm::cross(forward, helper));
    return {right, glm::cross(forward, right), forward};
}

glm::dvec3 corner(const Aabb& box, int i)
{
    return {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y, i & 4 ? box.upper.z : box.lower.z};
}

/// Least depth of the box along an axis from `point`.
double nearestAlong(const Aabb& box, glm::dvec3 point, glm::dvec3 forward)
{
    double nearest = glm::dot(corner(box, 0) - point, forward);
    for (int i = 1; i < 8; ++i)
        nearest = std::min(nearest, glm::dot(corner(box, i) - point, forward));
    return nearest;
}

/// And in the faces of a cube around `point`: what is at distance d is at least d / sqrt(3) deep in its face.
double nearestInFace(const Aabb& box, glm::dvec3 point)
{
    return nearestDistance(box, point) / std::sqrt(3.0);
}

/// Per axis, the distance of the box's farther side.
glm::dvec3 farthestOffset(const Aabb& box, glm::dvec3 point)
{
    return glm::max(glm::abs(glm::dvec3(box.lower) - point), glm::abs(glm::dvec3(box.upper) - point));
}

/// World -> light: rotation, then `zero` becomes the origin.
glm::dmat4 lightFromWorld(const Axes& axes, glm::dvec3 zero)
{
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(axes.right, axes.down, axes.forward));
    glm::dmat4 result(rotation);
    result[3] = glm::dvec4(-(rotation * zero), 1.0);
    return result;
}

/// Square pyramid of half-angle tangent `slope` along +z: clip w = z, depth 0 at near and 1 at far.
/// Depth is 1 - near / w: without a far end, where casters are left out by their bounds. So what a vertex contributes
/// to its depth is a constant beside its w, which no clipping rounds (shaders/shared/caster_clip.glsl).
glm::dmat4 perspective(double slope, double near)
{
    glm::dmat4 clip(0.0);
    clip[0][0] = clip[1][1] = 1.0 / slope;
    clip[2][2] = 1.0;
    clip[3][2] = -near;
    clip[2][3] = 1.0;
    return clip;
}

Plane planeOf(glm::dvec4 equation)
{
    const double length = glm::length(glm::dvec3(equation));
    return {glm::vec3(glm::dvec3(equation) / length), static_cast<float>(equation.w / length)};
}

/// The six sides of clip space: -w <= x <= w, -w <= y <= w, 0 <= z <= w, as planes in world space. The far side is
/// given apart: as row difference it would vanish in rounding where far / near is large.
std::array<Plane, 6> volumeOf(const glm::dmat4& clipFromWorld, glm::dvec4 farSide)
{
    const glm::dmat4 rows = glm::transpose(clipFromWorld);
    return {planeOf(rows[3] + rows[0]), planeOf(rows[3] - rows[0]), planeOf(rows[3] + rows[1]),
            planeOf(rows[3] - rows[1]), planeOf(rows[2]),           planeOf(farSide)};
}

struct Depths {
    double near, far, end;
};

/// `nearest` and `farthest`: what of the scene there is, metres along the map's axis.
Depths depthsOf(const LightView& light, double nearest, double farthest)
{
    const double past = farthest > 0.0 ? farthest * (1.0 + kRoom) : 1.0; // no casters: any depth does
    const double far = light.unlimited() ? past : static_cast<double>(light.constants.range);
    const double end = std::min(past, far);
    return {std::clamp(nearest, std::min(kNearPerFar * end, kMostNearWs), 0.9 * far), far,
            end}; // 0.9: all casters may be past the range
}

LightFit perspectiveFit(const Axes& axes, glm::dvec3 eye, double slope, Depths depths)
{
    const glm::dmat4 clipFromWorld = perspective(slope, depths.near) * lightFromWorld(axes, eye);
    LightFit fit;
    fit.clipFromWorld = glm::mat4(clipFromWorld);
    fit.volume = volumeOf(clipFromWorld, {-axes.forward, depths.far + glm::dot(axes.forward, eye)});
    fit.nearWs = static_cast<float>(depths.near);
    fit.farWs = static_cast<float>(depths.far);
    fit.endWs = static_cast<float>(depths.end);
    fit.texelAtOne = static_cast<float>(2.0 * slope);
    return fit;
}

/// By how much a map is wider than what lies inside a border; half the resolution at most is border.
double widening(std::uint32_t resolution, float borderTexels)
{
    return 1.0 / (1.0 - std::min(2.0 * static_cast<double>(borderTexels) / resolution, 0.5));
}

/// Tangent of a cone that holds every receiver the shaders find in the light's. They compare cosines in float
/// (reaches(), shaders/shared/receiver.h): those of light and receiver are off by 2^-21 at most, which a tenth of a
/// degree is not far above. tan^2 = 1 / cos^2 - 1, so that it is off by 2^-20 / cos^3.
double coneSlope(double halfAngle)
{
    const double square = std::tan(halfAngle) * std::tan(halfAngle);
    return std::sqrt(square + 0x1p-20 * std::pow(1.0 + square, 1.5));
}

} // namespace

double nearestDistance(const Aabb& box, glm::dvec3 point)
{
    const glm::dvec3 beside = glm::max(glm::max(glm::dvec3(box.lower) - point, point - glm::dvec3(box.upper)), 0.0);
    return glm::length(beside);
}

LightFit fitSpot(const LightView& light, const Aabb& scene, std::uint32_t resolution, float borderTexels)
{
    const glm::dvec3 eye(light.position());
    const Axes axes = axesAlong(glm::normalize(glm::dvec3(light.direction())));
    const Depths depths = depthsOf(light, nearestAlong(scene, eye, axes.forward) * (1.0 - kRoom),
                                   -nearestAlong(scene, eye, -axes.forward));
    const double slope = coneSlope(static_cast<double>(light.coneAngle)) * widening(resolution, borderTexels);
    return perspectiveFit(axes, eye, slope, depths);
}

LightFit fitDirectional(const LightView& light, const Aabb& scene)
{
    const Axes axes = axesAlong(glm::normalize(glm::dvec3(light.direction())));
    const glm::dmat3 lightFromScene = glm::transpose(glm::dmat3(axes.right, axes.down, axes.forward));
    const glm::dvec3 center = lightFromScene * (0.5 * (glm::dvec3(scene.lower) + glm::dvec3(scene.upper)));
    const glm::dvec3 boxHalf = 0.5 * (glm::dvec3(scene.upper) - glm::dvec3(scene.lower));
    glm::dvec3 half(0.0);
    for (int axis = 0; axis < 3; ++axis)
        half += glm::abs(lightFromScene[axis]) * boxHalf[axis];
    // A flat scene gets some depth; the coordinates themselves are floats of this size.
    const double largest = std::max({half.x, half.y, half.z, 1e-3, kRoom * glm::length(center) / 1024.0});
    half = glm::max(half * (1.0 + kRoom), largest * kRoom);

    // x, y: [-half, half] -> [-1, 1]; z: [-half, half] -> [0, 1].
    glm::dmat4 clip(1.0);
    clip[0][0] = 1.0 / half.x;
    clip[1][1] = 1.0 / half.y;
    clip[2][2] = 0.5 / half.z;
    clip[3] = glm::dvec4(-center.x / half.x, -center.y / half.y, 0.5 - 0.5 * center.z / half.z, 1.0);
    const glm::dmat4 clipFromWorld = clip * lightFromWorld(axes, glm::dvec3(0.0));

    LightFit fit;
    fit.clipFromWorld = glm::mat4(clipFromWorld);
    fit.volume = volumeOf(clipFromWorld, {-axes.forward, center.z + half.z});
    fit.nearWs = static_cast<float>(center.z - half.z);
    fit.farWs = static_cast<float>(center.z + half.z);
    fit.texelAtOne = static_cast<float>(2.0 * std::max(half.x, half.y));
    return fit;
}

LightFit fitWindow(const LightFit& whole, glm::dvec2 middle, glm::dvec2 half)
{
    glm::dmat4 rows = glm::transpose(glm::dmat4(whole.clipFromWorld));
    for (int axis = 0; axis < 2; ++axis) {
        const glm::dvec3 direction = glm::normalize(glm::dvec3(rows[axis]));
        rows[axis] = glm::dvec4(direction, -middle[axis]) / half[axis];
    }
    const glm::dmat4 clipFromWorld = glm::transpose(rows);
    LightFit fit = whole;
    fit.clipFromWorld = glm::mat4(clipFromWorld);
    const Plane& end = whole.volume[5];
    fit.volume = volumeOf(clipFromWorld, glm::dvec4(glm::dvec3(end.normal), static_cast<double>(end.distance)));
    fit.texelAtOne = static_cast<float>(2.0 * std::max(half.x, half.y));
    return fit;
}

LightFit fitProjected(const LightFit& whole, const glm::dmat3& map, double least)
{
    const glm::dmat4 from = glm::transpose(glm::dmat4(whole.clipFromWorld));
    const glm::dmat3 rowsOfMap = glm::transpose(map);
    const auto row = [&](int i) {
        return rowsOfMap[i].x * from[0] + rowsOfMap[i].y * from[1] + rowsOfMap[i].z * from[3];
    };
    glm::dmat4 rows(row(0), row(1), least * from[2], row(2));
    LightFit fit = whole;
    if (glm::dvec3(from[3]) != glm::dvec3(0.0)) { // w is metres again, now along the axis that `map` leaves
        const double unit = 1.0 / glm::length(glm::dvec3(rows[3]));
        const double near = least * unit * static_cast<double>(whole.nearWs);
        for (const int i : {0, 1, 3})
            rows[i] *= unit;
        rows[2] = rows[3];
        rows[2].w -= near;
        fit.nearWs = static_cast<float>(near);
    }
    const glm::dmat4 clipFromWorld = glm::transpose(rows);
    fit.clipFromWorld = glm::mat4(clipFromWorld);
    const std::array<Plane, 6> sides = volumeOf(clipFromWorld, {1.0, 0.0, 0.0, 0.0});
    std::copy_n(sides.begin(), 4, fit.volume.begin());
    return fit;
}

LightFit fitCubeFace(const LightView& light, const Aabb& scene, std::uint32_t face, std::uint32_t resolution,
                     float borderTexels)
{
    const glm::dvec3 eye(light.position());
    glm::dvec3 forward(0.0);
    forward[face / 2] = face % 2 ? -1.0 : 1.0;
    const glm::dvec3 farthest = farthestOffset(scene, eye);
    const Depths depths =
        depthsOf(light, nearestInFace(scene, eye) * (1.0 - kRoom), std::max({farthest.x, farthest.y, farthest.z}));
    // The inner resolution - 2 border texels span 90 degrees.
    return perspectiveFit(axesAlong(forward), eye, widening(resolution, borderTexels), depths);
}

double touchingDistance(const LightView& light, double extent) noexcept
{
    const glm::dvec3 position = glm::abs(glm::dvec3(light.position()));
    return 0x1p-21 * std::max({position.x, position.y, position.z, extent});
}

float nearestDepth(const LightView& light, const Aabb& box)
{
    const glm::dvec3 eye(light.position());
    const double nearest = light.type == GN_LIGHT_TYPE_SPOT
                               ? nearestAlong(box, eye, glm::normalize(glm::dvec3(light.direction())))
                               : nearestInFace(box, eye);
    return static_cast<float>(nearest * (1.0 - kRoom));
}

float casterReach(const LightView& light, const Aabb& scene)
{
    const double farthest = glm::length(farthestOffset(scene, glm::dvec3(light.position())));
    const double past = farthest > 0.0 ? farthest * (1.0 + kRoom) : 1.0; // no casters: any distance does
    return static_cast<float>(std::min(past, static_cast<double>(light.constants.range)));
}

namespace {

Aabb boundsOf(std::span<const Caster* const> casters)
{
    Aabb result = casters.front()->bounds;
    for (const Caster* caster : casters) {
        result.lower = glm::min(result.lower, caster->bounds.lower);
        result.upper = glm::max(result.upper, caster->bounds.upper);
    }
    return result;
}

} // namespace

Aabb sceneBounds(const LightCasters& casters)
{
    if (casters.all.empty()) return {};
    if (casters.dynamics.empty()) return boundsOf(casters.statics);
    const Aabb moving = boundsOf(casters.dynamics);
    Aabb result = casters.statics.empty() ? moving : boundsOf(casters.statics);
    const Aabb inner = result;
    for (int axis = 0; axis < 3; ++axis) {
        // Steps of 1/16 to 1/8 of the extent: a map loses at most 1/8 of its resolution a side, and a caster crosses a
        // step only now and then.
        const float extent =
            std::max(moving.upper[axis], inner.upper[axis]) - std::min(moving.lower[axis], inner.lower[axis]);
        const float step = extent > 0.0f ? std::exp2(std::floor(std::log2(extent)) - 3.0f) : 0.0f;
        const bool alone = casters.statics.empty();
        const auto outward = [step](float value, bool up) {
            if (step == 0.0f) return value;
            const float rounded = (up ? std::ceil(value / step) : std::floor(value / step)) * step;
            return up ? std::max(rounded, value) : std::min(rounded, value);
        };
        if (alone || moving.lower[axis] < inner.lower[axis]) result.lower[axis] = outward(moving.lower[axis], false);
        if (alone || moving.upper[axis] > inner.upper[axis]) result.upper[axis] = outward(moving.upper[axis], true);
    }
    return result;
}

} // namespace gnomon
