#include "algorithms/shared/paraboloid_fit.hpp"

#include <cmath>

#include <glm/geometric.hpp>

namespace gnomon {

namespace {

// A cone's half angle is widened by this, radians: corners of a near rectangle of centimetres are rounded by as much.
constexpr float kConeSlack = 0x1p-10f;
// Cosine of the half angle of the narrowest cone, half a degree: directions are rounded by a hundredth of its texels.
constexpr float kNarrowestCosine = 0.99996f;
// Of the widest that a pyramid is put around to leave casters out: 80 degrees.
constexpr float kNarrowCosine = 0.17f;

// Steps from the middle of a cube's face to its edge that a direction is rounded to.
constexpr float kSteps = 16.0f;

gpu::Paraboloid withAxes(glm::vec3 right, glm::vec3 axis, glm::vec3 pole, glm::vec2 centre, float scale)
{
    return {glm::vec4(right, centre.x), glm::vec4(glm::cross(axis, right), centre.y), glm::vec4(axis, scale),
            glm::vec4(pole, 0.0f)};
}

/// Bit i: the view sees something on the side of hemisphere i.
std::uint32_t neededHemispheres(const ShadowTask& task, const ParaboloidSet& set, MapCulling culling)
{
    if (culling < MapCulling::parts) return 3;
    const Frustum visible = frustumOf(*task.view, *task.light);
    std::uint32_t needed = 0;
    for (std::uint32_t i = 0; i < 2; ++i) {
        const glm::vec3 pole(set.parts[i].poleWs);
        if (touches(visible, planeThrough(task.light->position(), pole, 0.0f, 0.0f))) needed |= 1u << i;
    }
    return needed;
}

} // namespace

ParaboloidSet lowerAndUpper(const ShadowTask& task, std::uint32_t resolution, float reach, MapCulling culling)
{
    const glm::vec3 light = task.light->position(), right(1.0f, 0.0f, 0.0f);
    const float inner = innerShare(resolution);
    ParaboloidSet set{.cutSide = resolution};
    // Lights mostly hang above what they are seen to light, so that the upper half can often be left out.
    set.firstWs = {0.0f, -1.0f, 0.0f};
    for (std::size_t i = 0; i < 2; ++i) {
        const glm::vec3 pole = i == 0 ? set.firstWs : -set.firstWs;
        set.parts[i] = withAxes(right, pole, pole, glm::vec2(0.0f), inner);
        // The border shows at most asin(1 - inner) past the dividing plane.
        set.volumes[i][0] = planeThrough(light, pole, 1.0f - inner, reach);
    }
    set.needed = neededHemispheres(task, set, culling);
    return set;
}

// It touches three of the directions, or two that are opposite each other in it.
Cone coneAround(std::span<const glm::vec3> directions)
{
    Cone best;
    const auto attempt = [&](glm::vec3 axis) {
        const float length = glm::length(axis);
        if (!(length > 1e-6f)) return;
        axis /= length;
        float cosine = 1.0f;
        for (glm::vec3 direction : directions)
            cosine = std::fmin(cosine, glm::dot(axis, direction));
        if (cosine > std::fmax(best.cosine, 0.0f)) best = {axis, cosine};
    };
    for (std::size_t a = 0; a < directions.size(); ++a) {
        attempt(directions[a]); // where all are the same
        for (std::size_t b = 0; b < a; ++b) {
            attempt(directions[a] + directions[b]);
            for (std::size_t c = 0; c < b; ++c) {
                const glm::vec3 normal = glm::cross(directions[b] - directions[a], directions[c] - directions[a]);
                attempt(normal);
                attempt(-normal);
            }
        }
    }
    return best;
}

Cone coneOf(const Frustum& frustum, glm::vec3 light, float range)
{
    glm::vec3 deeper =
        glm::normalize(glm::cross(frustum.corners[1] - frustum.corners[0], frustum.corners[3] - frustum.corners[0]));
    if (glm::dot(deeper, frustum.runs[0]) < 0.0f) deeper = -deeper;
    const float run = glm::dot(deeper, frustum.runs[0]); // all are of the same depth
    const float middle = glm::dot(deeper, light - frustum.corners[0]);
    const float first = std::fmax((middle - range) / run, 0.0f);
    const float last = frustum.bounded ? std::fmin((middle + range) / run, 1.0f) : 0.0f;
    if (frustum.bounded && !(first < last)) return {glm::vec3(0.0f), 1.0f};
    std::array<glm::vec3, 8> directions{};
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 start = frustum.corners[i] - light;
        const glm::vec3 nearest = frustum.bounded ? start + first * frustum.runs[i] : start;
        const glm::vec3 farthest = frustum.bounded ? start + last * frustum.runs[i] : frustum.runs[i];
        if (!(glm::length(nearest) > 1e-6f) || !(glm::length(farthest) > 1e-6f)) return {};
        directions[i] = glm::normalize(nearest);
        directions[4 + i] = glm::normalize(farthest);
    }
    Cone cone = coneAround(directions);
    if (cone.cosine > 0.0f) cone.cosine = std::cos(std::acos(std::fmin(cone.cosine, kNarrowestCosine)) + kConeSlack);
    return cone;
}

ParaboloidSet cutToCone(const ShadowTask& task, const Cone& cone, std::uint32_t resolution, float reach)
{
    const glm::vec3 light = task.light->position(), right = beside(cone.axis), down = glm::cross(cone.axis, right);
    const float inner = innerShare(resolution), radius = discRadius(cone.cosine);
    // Edges bend less towards the centre of the disc, where the cone lies, than its texels are smaller.
    ParaboloidSet set{.needed = 1, .cutSide = resolution, .followsView = true};
    set.parts[0] = withAxes(right, cone.axis, cone.axis, glm::vec2(0.0f), inner / radius);
    // Filters look up to the map's edge, beyond the cone.
    const float half = 2.0f * std::atan(radius / inner), sine = std::sin(half), cosine = std::cos(half);
    if (cosine < kNarrowCosine) {
        set.volumes[0][0] = planeThrough(light, cone.axis, std::fmax(-cosine, 0.0f), reach);
        return set;
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 side = i < 2 ? right : down;
        set.volumes[0][i] = planeThrough(light, sine * cone.axis + (i % 2 ? cosine : -cosine) * side, 0.0f, reach);
    }
    return set;
}

glm::vec3 beside(glm::vec3 axis)
{
    const glm::vec3 size = glm::abs(axis);
    glm::vec3 other(0.0f);
    other[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1.0f;
    return glm::normalize(glm::cross(axis, other));
}

glm::vec3 beforeTheEye(const CameraView& view, glm::vec3 light)
{
    const glm::vec2 middle = glm::vec2(view.area.offset.x, view.area.offset.y) +
                             0.5f * glm::vec2(view.area.extent.width, view.area.extent.height);
    const glm::vec3 ahead = glm::normalize(gpu::lookingWs(view.constants, gpu::viewRayWs(view.constants, middle)));
    const glm::vec3 fromLight = view.eye - light;
    // Never zero: the point is nearer to the eye than the light is.
    const glm::vec3 towards = fromLight + 0.5f * glm::length(fromLight) * ahead;
    const glm::vec3 way = glm::length(towards) > 1e-6f ? towards : ahead;
    const glm::vec3 size = glm::abs(way);
    return glm::normalize(glm::round(way / std::fmax(size.x, std::fmax(size.y, size.z)) * kSteps));
}

ParaboloidSet skewedHalves(const ShadowTask& task, glm::vec3 pole, glm::vec3 dense, float skew,
                           std::uint32_t resolution, float reach, MapCulling culling)
{
    const float s = std::sin(skew), c = std::cos(skew), inner = innerShare(resolution);
    ParaboloidSet set;
    set.firstWs = pole;
    // Where the disc is densest, edges bend as in a plain map that is finer by the gain in density.
    set.cutSide = static_cast<std::uint32_t>(std::ceil(static_cast<float>(resolution) * (1.0f + s) / (1.0f - s)));
    set.followsView = true;
    for (std::size_t i = 0; i < 2; ++i) {
        const glm::vec3 middle = i == 0 ? pole : -pole;
        // The hemisphere is seen as a disc of radius 1 / c, moved by tan(skew) towards `dense`.
        set.parts[i] =
            withAxes(c * dense + s * middle, c * middle - s * dense, middle, glm::vec2(s / c, 0.0f), inner * c);
        // The border is widest in angles at the sparse end, where a unit of the map is c / (1 - s) radians.
        set.volumes[i][0] = planeThrough(task.light->position(), middle, (1.0f - inner) * c / (1.0f - s), reach);
    }
    set.needed = neededHemispheres(task, set, culling);
    return set;
}

} // namespace gnomon
