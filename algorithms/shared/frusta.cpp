#include "algorithms/shared/frusta.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace gnomon {

namespace {

// An endless edge whose direction leaves a plane by less than kParallel runs along it: that is what rounding leaves of
// a right angle, and what lies beside the plane by so little is less than a pixel (of a view of a degree it is a
// hundredth part of one). Coordinates of a few thousand metres are rounded by less than kSlack of the largest distance.
constexpr float kParallel = 0x1p-20f;
constexpr float kSlack = 0x1p-12f;
// Half angle, radians, of the widest shadow that a pyramid is put around: 75 degrees, whose tangent is 3.7.
constexpr float kWidestShadow = 1.31f;

struct Interval {
    float low = INFINITY, high = -INFINITY;
    void add(float value)
    {
        low = std::fmin(low, value);
        high = std::fmax(high, value);
    }
    void addRun(float slope)
    {
        if (slope > kParallel) high = INFINITY;
        if (slope < -kParallel) low = -INFINITY;
    }
};

Interval along(const Frustum& frustum, glm::vec3 apex, glm::vec3 axis)
{
    Interval result;
    for (std::size_t i = 0; i < 4; ++i) {
        const float start = glm::dot(frustum.corners[i] - apex, axis);
        const float run = glm::dot(frustum.runs[i], axis);
        result.add(start);
        if (frustum.bounded)
            result.add(start + run);
        else
            result.addRun(run);
    }
    return result;
}

Interval along(const std::array<glm::vec3, 4>& edges, glm::vec3 axis)
{
    Interval result;
    result.add(0.0f); // the apex
    for (glm::vec3 edge : edges)
        result.addRun(glm::dot(edge, axis));
    return result;
}

float extent(const Frustum& frustum, glm::vec3 from)
{
    float size = 1.0f;
    for (std::size_t i = 0; i < 4; ++i) {
        size = std::fmax(size, glm::length(frustum.corners[i] - from));
        if (frustum.bounded) size = std::fmax(size, glm::length(frustum.corners[i] + frustum.runs[i] - from));
    }
    return size;
}

} // namespace

Frustum frustumOf(const CameraView& view, const LightView& light)
{
    Frustum frustum;
    frustum.corners = view.nearCorners;
    frustum.bounded = !light.unlimited();
    const bool orthographic = gpu::isOrthographic(view.constants);
    const glm::vec3 straight = glm::vec3(view.constants.rayDepthWs) / view.constants.rayDepthWs.w;
    float reach = glm::length(light.position() - view.eye) + light.constants.range;
    for (const glm::vec3& corner : view.nearCorners) // where parallel rays leave from
        if (orthographic) reach = std::fmax(reach, glm::length(light.position() - corner) + light.constants.range);
    const glm::vec2 low(view.area.offset.x, view.area.offset.y);
    const glm::vec2 high = low + glm::vec2(view.area.extent.width, view.area.extent.height);
    const glm::vec2 ring[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
    for (std::size_t i = 0; i < 4; ++i) {
        // The rays themselves: the corners of a near rectangle of centimetres are rounded where the eye is far from the
        // origin. A ray's depth is 1, so that the end is a depth, not a distance: nothing within `reach` is cut off.
        const glm::vec3 ray = orthographic ? straight : gpu::viewRayWs(view.constants, ring[i]);
        frustum.runs[i] = frustum.bounded ? ray * reach : ray;
    }
    return frustum;
}

bool touches(const Frustum& frustum, const Plane& plane)
{
    const float slack = kSlack * extent(frustum, -plane.distance * plane.normal);
    return along(frustum, -plane.distance * plane.normal, plane.normal).high >= -slack;
}

bool meetsPyramid(const Frustum& frustum, glm::vec3 apex, const std::array<glm::vec3, 4>& edges)
{
    const float slack = kSlack * extent(frustum, apex);
    const auto apart = [&](glm::vec3 axis) {
        const float length = glm::length(axis);
        if (!(length > 1e-6f)) return false;
        const Interval a = along(frustum, apex, axis / length), b = along(edges, axis / length);
        return a.low > b.high + slack || a.high < b.low - slack;
    };
    std::array<glm::vec3, 4> runs;
    for (std::size_t i = 0; i < 4; ++i)
        runs[i] = glm::normalize(frustum.runs[i]);
    const glm::vec3 right = glm::normalize(frustum.corners[1] - frustum.corners[0]);
    const glm::vec3 down = glm::normalize(frustum.corners[3] - frustum.corners[0]);
    if (apart(glm::cross(right, down))) return false;
    for (std::size_t i = 0; i < 4; ++i) {
        if (apart(glm::cross(edges[i], edges[(i + 1) % 4])) || apart(glm::cross(runs[i], runs[(i + 1) % 4])))
            return false;
        if (apart(glm::cross(right, edges[i])) || apart(glm::cross(down, edges[i]))) return false;
        for (glm::vec3 run : runs)
            if (apart(glm::cross(run, edges[i]))) return false;
    }
    return true;
}

bool shadowMeets(const Frustum& frustum, glm::vec3 apex, const Aabb& box, float angle)
{
    const glm::vec3 middle = 0.5f * (box.lower + box.upper) - apex;
    const float radius = 0.5f * glm::length(box.upper - box.lower), distance = glm::length(middle);
    if (!(distance > radius)) return true;
    const float half = std::asin(radius / distance) + angle;
    if (!(half < kWidestShadow)) return true;
    const glm::vec3 axis = middle / distance;
    const glm::vec3 aside = std::fabs(axis.y) < 0.7f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 u = std::tan(half) * glm::normalize(glm::cross(axis, aside)), v = glm::cross(axis, u);
    return meetsPyramid(frustum, apex,
                        {glm::normalize(axis - u - v), glm::normalize(axis + u - v), glm::normalize(axis + u + v),
                         glm::normalize(axis - u + v)});
}

std::span<const Caster* const> castersSeen(MapCulling culling, const Frustum& visible, glm::vec3 light, float angle,
                                           std::span<const Caster* const> casters, FrameArena& arena)
{
    if (culling != MapCulling::shadows) return casters;
    const std::span<const Caster*> kept = arena.array<const Caster*>(casters.size());
    const auto seen = [&](const Caster* caster) { return shadowMeets(visible, light, caster->bounds, angle); };
    return {kept.begin(), std::copy_if(casters.begin(), casters.end(), kept.begin(), seen)};
}

std::array<glm::vec3, 4> cubeFaceEdges(std::uint32_t face)
{
    const std::uint32_t axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<glm::vec3, 4> edges;
    for (std::uint32_t i = 0; i < 4; ++i) {
        glm::vec3 edge(0.0f);
        edge[axis] = face % 2 ? -1.0f : 1.0f;
        edge[u] = i == 0 || i == 3 ? -1.0f : 1.0f;
        edge[v] = i < 2 ? -1.0f : 1.0f;
        edges[i] = glm::normalize(edge);
    }
    return edges;
}

} // namespace gnomon
