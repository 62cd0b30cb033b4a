#include "algorithms/shared/trapezoid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace gnomon {

namespace {

/// Where receivers are along view rays is a guess: a mean texel below this part of the plain map's is one that is worth
/// the change. In scenes that are seen whole it keeps maps that would be up to a tenth coarser out (`colonnade`).
constexpr double kClearlySmaller = 0.9;

/// Least w of a warped map in parts of the distance from a spot light. Warps tilt the axis along which w is counted,
/// the more the narrower what is seen is from the light. Along a ray receivers are moved by SNAP_TEXELS, 1/64, of what
/// w changes from texel to texel, here four texels, and w is rounded as the distance is, over this share. A lamp 100 km
/// away that is seen through a lens of one degree made two thirds of the picture shadow itself at 1/1024; at 1/256 the
/// picture is as right as the plain map's.
constexpr double kLeastShare = 1.0 / 256.0;

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(double value)
    {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double size() const { return high - low; }
};

/// Points as lengths along the warp's way and across it.
struct Frame {
    glm::dvec2 away, right; ///< right, away: turned as the plane's x, y are, so that nothing is mirrored.
    Range along;

    double w(glm::dvec2 p, double strength) const
    {
        return 1.0 + strength * (glm::dot(p, away) - along.low) / along.size();
    }
};

/// The sides' slopes, as x / w, from a point on the line where w is 0 and `across` is `from`.
Range slopes(std::span<const glm::dvec2> points, const Frame& frame, double strength, double from)
{
    Range range;
    for (const glm::dvec2 p : points)
        range.add((glm::dot(p, frame.right) - from) / frame.w(p, strength));
    return range;
}

/// Where the sides meet so that they stand least apart. Their distance is convex in it: the largest of linear functions
/// less the smallest. Golden section: 40 steps leave 1e-8 of the range.
double narrowest(std::span<const glm::dvec2> points, const Frame& frame, double strength)
{
    Range across;
    for (const glm::dvec2 p : points)
        across.add(glm::dot(p, frame.right));
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double low = across.low, high = across.high;
    for (int step = 0; step < 40; ++step) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        if (slopes(points, frame, strength, a).size() <= slopes(points, frame, strength, b).size())
            high = b;
        else
            low = a;
    }
    return 0.5 * (low + high);
}

} // namespace

Trapezoid trapezoidAround(std::span<const glm::dvec2> points, const Warp& warp)
{
    Frame frame{.away = warp.away, .right = {warp.away.y, -warp.away.x}, .along = {}};
    for (const glm::dvec2 p : points)
        frame.along.add(glm::dot(p, frame.away));
    const double k = warp.strength, length = frame.along.size();
    const double from = narrowest(points, frame, k);
    const Range sides = slopes(points, frame, k, from);
    const double middle = 0.5 * (sides.low + sides.high), half = 0.5 * sides.size();

    // Rows over (x, y, 1): t, what is across, w; then the square's x, and y = -1 + (2 + k) t, which is 1 + k at t = 1.
    const glm::dvec3 one(0.0, 0.0, 1.0);
    const glm::dvec3 t = glm::dvec3(frame.away, -frame.along.low) / length;
    const glm::dvec3 w = one + k * t;
    const glm::dvec3 x = (glm::dvec3(frame.right, -from) - middle * w) / half;
    const glm::dvec3 y = (2.0 + k) * t - one;
    Trapezoid result{.corners = {}, .map = glm::transpose(glm::dmat3(x, y, w))};
    for (std::size_t i = 0; i < 4; ++i) {
        const bool far = i >= 2, right = i == 1 || i == 2;
        const double across = from + (right ? sides.high : sides.low) * (far ? 1.0 + k : 1.0);
        result.corners[i] = across * frame.right + (far ? frame.along.high : frame.along.low) * frame.away;
    }
    return result;
}

LightFit fitWarped(const LightFit& plain, const SeenPart& part, std::span<const Warp> warps, std::uint32_t resolution,
                   float borderTexels)
{
    if (part.hull.count == 0) return plain;
    const MapPlane plane(plain);
    const double inside = 1.0 - std::min(2.0 * static_cast<double>(borderTexels) / resolution, 0.5);
    double best = kClearlySmaller * meanTexel(part, glm::inverse(plane.fromClip(glm::dmat3(1.0))));
    double least = 0.0;
    glm::dmat3 map(1.0);
    const bool positional = glm::dvec3(plane.rows[2]) != glm::dvec3(0.0);
    for (const Warp& warp : warps) {
        glm::dmat3 rows = glm::transpose(trapezoidAround(part.hull.points(), warp).map);
        rows[0] *= inside;
        rows[1] *= inside;
        const double mean = meanTexel(part, glm::transpose(rows));
        if (!(mean < best)) continue;
        // w is least at the near edge, where y / w = -1: at t = (1 - 1 / inside) / (2 + k + k / inside).
        const double k = warp.strength;
        const double nearW = 1.0 + k * (1.0 - 1.0 / inside) / (2.0 + k + k / inside);
        if (positional && nearW < kLeastShare * glm::length(rows[2])) continue;
        best = mean;
        map = glm::transpose(rows);
        least = nearW;
    }
    return least > 0.0 ? fitProjected(plain, plane.fromClip(map), least) : plain;
}

glm::dvec2 smallestRectangle(std::span<const glm::dvec2> polygon)
{
    glm::dvec2 result(1.0, 0.0);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 side = polygon[(i + 1) % polygon.size()] - polygon[i];
        const double length = glm::length(side);
        if (!(length > 0.0)) continue;
        const glm::dvec2 away = side / length, right(away.y, -away.x);
        Range along, across;
        for (const glm::dvec2 p : polygon) {
            along.add(glm::dot(p, away));
            across.add(glm::dot(p, right));
        }
        const double area = along.size() * across.size();
        if (area >= least) continue;
        least = area;
        result = away;
    }
    return result;
}

const LightFit* fitSeenMap(Clamped clamped, const ShadowTask& task, std::uint32_t resolution, FrameArena& arena,
                           std::uint32_t borderTexels)
{
    const LightFit& plain = *fitDepthMap(clamped, task, resolution, arena, borderTexels);
    const SeenPart part = seenPart(task, plain);
    const Warp rectangle{smallestRectangle(part.hull.points()), 0.0};
    return arena.make(fitWarped(plain, part, {&rectangle, 1}, resolution, static_cast<float>(borderTexels)));
}

double focusStrength(double focus)
{
    return std::max(4.0 / focus - 5.0, 0.0);
}

} // namespace gnomon
