#include "algorithms/shared/seen_part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

namespace gnomon {

namespace {

/// Largest distances of what is seen, over that to the casters' farthest: a view without a far end is cut off there.
/// What is shaded so far away spans a thousandth of what the casters do.
constexpr double kFarCut = 1024.0;
/// Planes whose normals span less than this meet nowhere that can be computed.
constexpr double kParallel = 1e-9;
/// By what share of its distance a corner may lie outside: planes are rounded to float.
constexpr double kOutside = 1e-7;
/// In parts of a polygon's extent: corners that are one, and (in parts of its square) how much a corner turns. Two
/// corners of a box that light runs along fall on one place up to rounding, and the way between them is none.
constexpr double kSame = 1e-9, kStraight = 1e-12;

double cross(glm::dvec2 a, glm::dvec2 b)
{
    return a.x * b.y - a.y * b.x;
}

/// A convex body as half-spaces, about the eye. Its corners are found among the points where three planes meet: no
/// topology that rounding could break, and at most 286 points of 13 planes.
class Body {
public:
    static constexpr std::size_t kMostPlanes = 13, kMostCorners = 286;

    explicit Body(glm::dvec3 zero) : zero_(zero) {}

    void add(const Plane& plane)
    {
        const glm::dvec3 normal(plane.normal);
        if (normal == glm::dvec3(0.0) || count_ == kMostPlanes) return; // a far plane that there is not
        planes_[count_++] = {normal, static_cast<double>(plane.distance) + glm::dot(normal, zero_)};
    }

    template <typename Use> // void(glm::dvec3): a corner, world
    void forCorners(const Use& use) const
    {
        for (std::size_t i = 0; i < count_; ++i)
            for (std::size_t j = i + 1; j < count_; ++j)
                for (std::size_t k = j + 1; k < count_; ++k) {
                    const glm::dvec3 a(planes_[i]), b(planes_[j]), c(planes_[k]);
                    const glm::dvec3 bc = glm::cross(b, c);
                    const double span = glm::dot(a, bc);
                    if (std::abs(span) < kParallel) continue;
                    const glm::dvec3 point =
                        -(planes_[i].w * bc + planes_[j].w * glm::cross(c, a) + planes_[k].w * glm::cross(a, b)) / span;
                    if (holds(point)) use(zero_ + point);
                }
    }

    /// The part of start + s run that lies in it, of s from `range.x` to `range.y`; none where y < x.
    glm::dvec2 along(glm::dvec3 start, glm::dvec3 run, glm::dvec2 range) const
    {
        for (std::size_t i = 0; i < count_; ++i) {
            const glm::dvec3 normal(planes_[i]);
            const double at = glm::dot(normal, start - zero_) + planes_[i].w, slope = glm::dot(normal, run);
            if (slope > 0.0)
                range.x = std::max(range.x, -at / slope);
            else if (slope < 0.0)
                range.y = std::min(range.y, -at / slope);
            else if (at < 0.0)
                range.y = -1.0;
        }
        return range;
    }

private:
    bool holds(glm::dvec3 point) const
    {
        const double slack = kOutside * (1e-3 + glm::length(point));
        return std::all_of(
            planes_.begin(), planes_.begin() + static_cast<std::ptrdiff_t>(count_),
            [&](const glm::dvec4& plane) { return glm::dot(glm::dvec3(plane), point) + plane.w >= -slack; });
    }

    glm::dvec3 zero_;
    std::array<glm::dvec4, kMostPlanes> planes_{};
    std::size_t count_ = 0;
};

glm::dvec3 cornerOf(const Aabb& box, int i)
{
    return {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y, i & 4 ? box.upper.z : box.lower.z};
}

glm::dvec3 inPlane(const MapPlane& plane, glm::dvec3 point)
{
    const glm::dvec4 p(point, 1.0);
    return {glm::dot(plane.rows[0], p), glm::dot(plane.rows[1], p), glm::dot(plane.rows[2], p)};
}

bool positional(const ShadowTask& task)
{
    return task.light->type != GN_LIGHT_TYPE_DIRECTIONAL;
}

/// What the view sees, to the far cut.
Body seenBody(const CameraView& view, const Aabb& casters)
{
    Body body((glm::dvec3(view.eye)));
    for (const Plane& plane : view.frustum)
        body.add(plane);
    double reach = 1.0;
    for (int i = 0; i < 8; ++i)
        reach = std::max(reach, glm::length(cornerOf(casters, i) - glm::dvec3(view.eye)));
    const glm::vec3 axis = view.frustum[4].normal;
    body.add({-axis, glm::dot(axis, view.eye) + static_cast<float>(kFarCut * reach)});
    return body;
}

/// The part of the map that casters' bounds fall on; no corners where they reach behind the light's plane.
MapPolygon castersPart(const MapPlane& plane, const Aabb& casters)
{
    std::array<glm::dvec2, 8> points;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 at = inPlane(plane, cornerOf(casters, i));
        if (!(at.z > 1e-3)) return {};
        points[static_cast<std::size_t>(i)] = glm::dvec2(at) / at.z;
    }
    return convexHull(points);
}

glm::dvec2 middleOf(const MapPolygon& polygon)
{
    glm::dvec2 sum(0.0);
    double area = 0.0;
    const glm::dvec2 first = polygon.corners[0];
    for (std::size_t i = 1; i + 1 < polygon.count; ++i) {
        const glm::dvec2 a = polygon.corners[i] - first, b = polygon.corners[i + 1] - first;
        const double part = cross(a, b);
        sum += part * (a + b) / 3.0;
        area += part;
    }
    return first + (area != 0.0 ? sum / area : glm::dvec2(0.0));
}

/// How the view's axis and the light's rays lie to each other.
void addAxis(SeenPart& part, const MapPlane& plane, const CameraView& view)
{
    if (gpu::isOrthographic(view.constants)) return; // pixels are equally wide everywhere
    const glm::dvec3 axis(view.frustum[4].normal);
    const glm::dvec3 eye = inPlane(plane, glm::dvec3(view.eye));
    const glm::dvec3 run(glm::dot(glm::dvec3(plane.rows[0]), axis), glm::dot(glm::dvec3(plane.rows[1]), axis),
                         glm::dot(glm::dvec3(plane.rows[2]), axis));
    // Of (eye + s run) / w by s, up to what is positive: the same everywhere on the axis, before and behind the light.
    const glm::dvec2 away = glm::dvec2(run) * eye.z - glm::dvec2(eye) * run.z;
    const double length = glm::length(away);
    if (!(length > 1e-12)) return; // along the light
    part.away = away / length;
    const glm::dvec3 middle(middleOf(part.hull), 1.0);
    // The ray's direction: what the plane's x, y and w say, in world axes of any turn.
    const bool parallel = glm::dvec3(plane.rows[2]) == glm::dvec3(0.0);
    const glm::dvec3 ray = parallel ? glm::cross(glm::dvec3(plane.rows[0]), glm::dvec3(plane.rows[1]))
                                    : middle.x * glm::dvec3(plane.rows[0]) + middle.y * glm::dvec3(plane.rows[1]) +
                                          glm::dvec3(plane.rows[2]);
    part.sine = glm::length(glm::cross(axis, glm::normalize(ray)));
}

/// Where receivers may be: where along rays is not known. Steps grow from the near end on, as floors are seen.
void addSamples(SeenPart& part, const MapPlane& plane, const CameraView& view, const Body& among)
{
    const VkRect2D& area = view.area;
    for (std::uint32_t i = 0; i < 16; ++i) {
        const glm::vec2 pixel(static_cast<float>(area.offset.x) +
                                  0.25f * (0.5f + static_cast<float>(i % 4)) * static_cast<float>(area.extent.width),
                              static_cast<float>(area.offset.y) +
                                  0.25f * (0.5f + static_cast<float>(i / 4)) * static_cast<float>(area.extent.height));
        const glm::dvec3 start(view.eye), run(gpu::viewRayWs(view.constants, pixel));
        const glm::dvec2 range = among.along(start, run, {kNearestReceiver, part.farthest});
        for (int step = 0; step < 4 && range.y > range.x; ++step) {
            const double depth = range.x + (range.y - range.x) * 0.0625 * (0.5 + step) * (0.5 + step);
            const glm::dvec3 at = inPlane(plane, start + depth * run);
            if (at.z > 0.0) part.samples[part.sampleCount++] = {glm::dvec2(at) / at.z, at.z / depth};
        }
    }
}

} // namespace

MapPlane::MapPlane(const LightFit& fit)
{
    const glm::dmat4 clip = glm::transpose(glm::dmat4(fit.clipFromWorld));
    for (int axis = 0; axis < 2; ++axis) {
        half[axis] = 1.0 / glm::length(glm::dvec3(clip[axis]));
        rows[axis] = clip[axis] * half[axis];
    }
    rows[2] = clip[3];
}

glm::dmat3 MapPlane::fromClip(const glm::dmat3& map) const
{
    return {map[0] * half.x, map[1] * half.y, map[2]};
}

double meanTexel(const SeenPart& part, const glm::dmat3& map)
{
    if (part.sampleCount == 0) return std::numeric_limits<double>::infinity();
    const glm::dmat3 rows = glm::transpose(map);
    double sum = 0.0;
    for (std::size_t i = 0; i < part.sampleCount; ++i) {
        const glm::dvec3 p(part.samples[i].at, 1.0);
        const double w = glm::dot(rows[2], p);
        if (!(w > 0.0)) return std::numeric_limits<double>::infinity();
        const glm::dvec2 dx = (glm::dvec2(rows[0]) - glm::dvec2(rows[2]) * (glm::dot(rows[0], p) / w)) / w;
        const glm::dvec2 dy = (glm::dvec2(rows[1]) - glm::dvec2(rows[2]) * (glm::dot(rows[1], p) / w)) / w;
        const double area = std::abs(cross(dx, dy));                                // of the map, for one of the plane
        sum += part.samples[i].weight * (glm::length(dx) + glm::length(dy)) / area; // sides of a texel
    }
    return sum / static_cast<double>(part.sampleCount);
}

MapPolygon convexHull(std::span<glm::dvec2> points)
{
    std::sort(points.begin(), points.end(),
              [](glm::dvec2 a, glm::dvec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    MapPolygon hull;
    if (points.empty()) return hull;
    const auto [low, high] =
        std::minmax_element(points.begin(), points.end(), [](glm::dvec2 a, glm::dvec2 b) { return a.y < b.y; });
    const double extent = std::max(points.back().x - points.front().x, high->y - low->y);
    const auto same = [&](glm::dvec2 a, glm::dvec2 b) { return glm::length(a - b) <= kSame * extent; };
    std::array<glm::dvec2, MapPolygon::kMost>& out = hull.corners;
    const auto add = [&](glm::dvec2 p, std::size_t start) { // Andrew's monotone chain
        if (hull.count > 0 && same(out[hull.count - 1], p)) return;
        while (hull.count >= start + 2 &&
               cross(out[hull.count - 1] - out[hull.count - 2], p - out[hull.count - 2]) <= kStraight * extent * extent)
            --hull.count;
        if (hull.count < out.size()) out[hull.count++] = p;
    };
    for (const glm::dvec2 p : points)
        add(p, 0);
    const std::size_t lower = hull.count - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;)
        add(points[i], lower);
    while (hull.count > 1 && same(out[hull.count - 1], out[0])) // the first again
        --hull.count;
    if (hull.count < 3) hull.count = 0;
    return hull;
}

MapPolygon overlap(const MapPolygon& of, const MapPolygon& with)
{
    MapPolygon result = of;
    for (std::size_t i = 0; i < with.count && result.count > 0; ++i) { // Sutherland and Hodgman 1974
        const glm::dvec2 from = with.corners[i], edge = with.corners[(i + 1) % with.count] - from;
        MapPolygon cut;
        for (std::size_t j = 0; j < result.count; ++j) {
            const glm::dvec2 a = result.corners[j], b = result.corners[(j + 1) % result.count];
            const double ofA = cross(edge, a - from), ofB = cross(edge, b - from);
            if (ofA >= 0.0 && cut.count < MapPolygon::kMost) cut.corners[cut.count++] = a;
            if ((ofA >= 0.0) != (ofB >= 0.0) && cut.count < MapPolygon::kMost)
                cut.corners[cut.count++] = a + (b - a) * (ofA / (ofA - ofB));
        }
        result = cut;
    }
    if (result.count < 3) result.count = 0;
    return result;
}

SeenPart seenPart(const ShadowTask& task, const LightFit& fit)
{
    const CameraView& view = *task.view;
    const Aabb casters = sceneBounds(*task.casters);
    const MapPlane plane(fit);
    Body body = seenBody(view, casters);
    for (int side = 0; side < 4; ++side)
        body.add(fit.volume[static_cast<std::size_t>(side)]);
    Body among = body; // the casters, in depth too
    among.add(fit.volume[4]);
    among.add(fit.volume[5]);
    if (positional(task)) {
        body.add({glm::vec3(plane.rows[2]), static_cast<float>(plane.rows[2].w) - fit.nearWs});
        if (!task.light->unlimited()) body.add(fit.volume[5]);
    }

    SeenPart part;
    std::array<glm::dvec2, Body::kMostCorners> points;
    std::size_t count = 0;
    body.forCorners([&](glm::dvec3 corner) {
        const glm::dvec3 at = inPlane(plane, corner);
        if (at.z > 0.0) points[count++] = glm::dvec2(at) / at.z;
    });
    part.hull = convexHull({points.data(), count});
    const MapPolygon shaded = castersPart(plane, casters);
    if (shaded.count > 0) part.hull = overlap(part.hull, shaded);
    if (part.hull.count == 0) return part;

    double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0, nearLight = nearest, farLight = 0.0;
    const glm::dvec3 axis(view.frustum[4].normal);
    among.forCorners([&](glm::dvec3 corner) {
        const double depth = glm::dot(axis, corner - glm::dvec3(view.eye)), w = inPlane(plane, corner).z;
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
        nearLight = std::min(nearLight, w);
        farLight = std::max(farLight, w);
    });
    if (farthest > nearest && nearest > 0.0) {
        part.nearest = nearest;
        part.farthest = farthest;
        part.metres = std::max(0.5 * (nearLight + farLight), 1e-3);
        addAxis(part, plane, view);
        if (!gpu::isOrthographic(view.constants)) addSamples(part, plane, view, among);
    }
    return part;
}

} // namespace gnomon
