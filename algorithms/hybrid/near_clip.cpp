#include "algorithms/hybrid/near_clip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace gnomon {

namespace {

/// A convex polygon on the near rectangle, from 0 to 1 along its width and height.
struct NearPart {
    // Whatever rounding makes of convexity, a cut keeps a corner or puts one on each edge that it crosses: half as many
    // again at most. From 4 by six cuts: 6, 9, 13, 19, 28, 42.
    std::array<glm::dvec2, 42> corners;
    std::size_t count = 0;
};

/// What is left where slope . corner + constant >= 0.
NearPart cut(const NearPart& part, const glm::dvec2& slope, double constant)
{
    const auto height = [&](const glm::dvec2& p) { return slope.x * p.x + slope.y * p.y + constant; };
    NearPart rest;
    for (std::size_t i = 0; i < part.count; ++i) {
        const glm::dvec2 &from = part.corners[i], &to = part.corners[(i + 1) % part.count];
        const double a = height(from), b = height(to);
        if (a >= 0.0) rest.corners[rest.count++] = from;
        if ((a >= 0.0) != (b >= 0.0)) rest.corners[rest.count++] = from + (to - from) * (a / (a - b));
    }
    return rest;
}

/// The part of the near rectangle within the box.
NearPart within(const Aabb& box, const std::array<glm::vec3, 4>& near)
{
    const glm::dvec3 base(near[0]), right = glm::dvec3(near[1]) - base, down = glm::dvec3(near[3]) - base;
    // Bounds, corners and depths are off by some roundings of their coordinates, 2^-24 each.
    const glm::dvec3 size = glm::max(glm::abs(glm::dvec3(box.lower)), glm::abs(glm::dvec3(box.upper)));
    const double margin = 0x1p-18 * (std::max({size.x, size.y, size.z}) + glm::length(right) + glm::length(down));
    NearPart part{.corners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}, .count = 4};
    for (int axis = 0; axis < 3 && part.count != 0; ++axis) {
        const glm::dvec2 slope(right[axis], down[axis]);
        part = cut(part, slope, base[axis] - static_cast<double>(box.lower[axis]) + margin);
        part = cut(part, -slope, static_cast<double>(box.upper[axis]) - base[axis] + margin);
    }
    return part;
}

} // namespace

NearClipRegion nearClip(const CameraView& view, std::span<const Caster* const> casters)
{
    if (view.oblique) return {.pixels = view.area, .receivers = {glm::vec3(-1e30f), glm::vec3(1e30f)}};
    glm::dvec2 first(1.0), last(0.0);
    Aabb bounds{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
    for (const Caster* caster : casters) {
        if (!caster->closed || caster->alphaTested) continue;
        const NearPart part = within(caster->bounds, view.nearCorners);
        if (part.count == 0) continue;
        bounds = {glm::min(bounds.lower, caster->bounds.lower), glm::max(bounds.upper, caster->bounds.upper)};
        for (std::size_t i = 0; i < part.count; ++i) {
            first = glm::min(first, part.corners[i]);
            last = glm::max(last, part.corners[i]);
        }
    }
    if (first.x > last.x) return {};
    // A depth is off by 2^-24 w^2 / near at most, at w <= size of the bounds: less than this up to sizes of 2^18 near.
    const glm::vec3 margin(glm::length(bounds.upper - bounds.lower) / 64.0f);
    const VkRect2D& area = view.area;
    NearClipRegion result{.receivers = {bounds.lower - margin, bounds.upper + margin}};
    const auto side = [](double from, double to, std::uint32_t size, std::int32_t& offset, std::uint32_t& extent) {
        const double begin = std::floor(from * size), end = std::min(std::floor(to * size) + 1.0, double(size));
        offset += static_cast<std::int32_t>(begin);
        extent = static_cast<std::uint32_t>(std::max(end - begin, 0.0));
    };
    result.pixels.offset = area.offset;
    side(first.x, last.x, area.extent.width, result.pixels.offset.x, result.pixels.extent.width);
    side(first.y, last.y, area.extent.height, result.pixels.offset.y, result.pixels.extent.height);
    return result;
}

} // namespace gnomon
