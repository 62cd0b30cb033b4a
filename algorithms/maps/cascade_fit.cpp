#include "algorithms/maps/cascade_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace gnomon {

namespace {

/// Share of a map's side to which its place is rounded.
constexpr double kPlaceStep = 1.0 / 8.0;
/// Linear depth from which slices are counted where the near plane is nearer, metres: growing from a plane at 0.1 m
/// most of them would lie before anything there is to see (cascades.md, Slices).
constexpr double kNearestSplit = 1.0;

/// The view's corner rays, of linear depth 1.
std::array<glm::dvec3, 4> cornerRays(const CameraView& view)
{
    const VkRect2D& area = view.area;
    std::array<glm::dvec3, 4> rays;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const glm::vec2 pixel(area.offset.x + static_cast<std::int32_t>(i & 1 ? area.extent.width : 0),
                              area.offset.y + static_cast<std::int32_t>(i & 2 ? area.extent.height : 0));
        rays[i] = glm::dvec3(gpu::viewRayWs(view.constants, pixel));
    }
    return rays;
}

double roundedUp(double value, double unit)
{
    return std::ceil(value / unit) * unit;
}

/// About what of the view lies between two linear depths.
struct Sphere {
    glm::dvec3 centre;
    double radius;
};

Sphere sliceSphere(glm::dvec3 eye, const std::array<glm::dvec3, 4>& rays, double near, double far)
{
    const glm::dvec3 axis = 0.25 * (rays[0] + rays[1] + rays[2] + rays[3]);
    // On the axis, as far from the near corners as from the far ones, but within the slice.
    const double along = glm::dot(axis, axis), corner = glm::dot(rays[0], rays[0]);
    const double depth = std::min(0.5 * (near + far) * corner / along, far);
    Sphere sphere{eye + depth * axis, 0.0};
    for (const glm::dvec3& ray : rays)
        for (const double end : {near, far})
            sphere.radius = std::max(sphere.radius, glm::length(eye + end * ray - sphere.centre));
    return sphere;
}

struct Slices {
    double begin;     ///< Linear depth of the first one.
    double near, far; ///< Of splitDepth().
};

/// Over all that casts, seen from where the eye is: from the near plane, or from before the casters, to their farthest.
/// Both ends are rounded, so that not every step of the camera changes the size of maps.
Slices slicesOf(const CameraView& view, const std::array<glm::dvec3, 4>& rays, const Aabb& casters)
{
    const double diagonal = glm::length(glm::dvec3(casters.upper) - glm::dvec3(casters.lower));
    const double distance = nearestDistance(casters, glm::dvec3(view.eye));
    double longest = 1.0; // of the rays: what is that far away is no nearer in linear depth than its share of them
    for (const glm::dvec3& ray : rays)
        longest = std::max(longest, glm::length(ray));
    const double step = diagonal > 0.0 ? std::exp2(std::floor(std::log2(diagonal)) - 3.0) : 1.0;
    const auto plane = static_cast<double>(gpu::linearDepth(view.constants, view.reversed() ? 1.0f : 0.0f));
    const double begin = std::max(plane, std::floor(distance / longest / step) * step);
    const double near = std::max(begin, kNearestSplit);
    return {begin, near, std::max(near, roundedUp(distance, step)) + diagonal};
}

/// The sides of the map of all casters, and where it lies along them.
struct Whole {
    Cascade all;
    glm::dvec3 sides[2]; ///< World, unit: right and down.
};

Whole wholeOf(const LightFit& fit, std::uint32_t layer)
{
    Whole whole{.all = {.fit = fit, .layer = layer}, .sides = {}};
    const glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clipFromWorld));
    for (int axis = 0; axis < 2; ++axis) {
        const double half = 1.0 / glm::length(glm::dvec3(rows[axis]));
        whole.sides[axis] = glm::dvec3(rows[axis]) * half;
        whole.all.middle[axis] = -rows[axis].w * half;
        whole.all.half[axis] = half;
    }
    return whole;
}

/// The map of a slice, along neither side wider than that of all casters.
Cascade windowOf(const Whole& whole, const Sphere& sphere, const CascadeSplit& split, const double (&origin)[3])
{
    const double texels = split.resolution, stepTexels = std::floor(kPlaceStep * texels);
    const double border = 2.0 * static_cast<double>(split.borderTexels) / texels;
    const double needed = sphere.radius / (1.0 - kPlaceStep - border);
    const double half = roundedUp(needed, std::exp2(std::floor(std::log2(needed)) - 5.0));
    const double step = 2.0 * half * stepTexels / texels; // whole texels, so that their grid stays
    Cascade window = whole.all;
    for (int axis = 0; axis < 2; ++axis) {
        if (half >= whole.all.half[axis]) continue;
        // Counted from the world's origin: the frame's moves with the eye.
        const double zero = glm::dot(whole.sides[axis], glm::dvec3(origin[0], origin[1], origin[2]));
        const double place = zero + glm::dot(whole.sides[axis], sphere.centre);
        window.middle[axis] = step * std::round(place / step) - zero;
        window.half[axis] = half;
    }
    window.fit = fitWindow(whole.all.fit, window.middle, window.half);
    return window;
}

} // namespace

double splitDepth(double near, double far, double share, double blend)
{
    const double even = near + share * (far - near), growing = near * std::pow(far / near, share);
    return blend * growing + (1.0 - blend) * even;
}

std::span<Cascade> fitCascades(const ShadowTask& task, const CascadeSplit& split, FrameArena& arena)
{
    const Aabb bounds = sceneBounds(*task.casters);
    const Whole whole = wholeOf(fitDirectional(*task.light, bounds), split.count - 1);
    const std::span<Cascade> cascades = arena.array<Cascade>(split.count);
    if (gpu::isOrthographic(task.view->constants)) { // pixels are equally wide everywhere: nothing to slice by
        cascades[0] = whole.all;
        return cascades.first(1);
    }
    const std::array<glm::dvec3, 4> rays = cornerRays(*task.view);
    const Slices slices = slicesOf(*task.view, rays, bounds);
    std::uint32_t used = 0;
    double begin = slices.begin;
    for (std::uint32_t i = 0; i + 1 < split.count; ++i) {
        const double end = splitDepth(slices.near, slices.far, (i + 1.0) / split.count, split.blend);
        const Sphere sphere = sliceSphere(glm::dvec3(task.view->eye), rays, begin, end);
        const Cascade window = windowOf(whole, sphere, split, task.view->origin);
        begin = end;
        if (window.half == whole.all.half) break;
        cascades[used] = window;
        cascades[used].layer = used;
        ++used;
    }
    cascades[used++] = whole.all;
    return cascades.first(used);
}

glm::vec4 cascadePart(const Cascade& finest, const Cascade& of, std::uint32_t resolution)
{
    const glm::dvec2 scale = finest.half / of.half;
    const glm::dvec2 moved = 0.5 * resolution * (1.0 + (finest.middle - of.middle - finest.half) / of.half);
    return {glm::vec2(scale), glm::vec2(moved)};
}

} // namespace gnomon
