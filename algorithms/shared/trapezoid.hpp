#pragma once
// Maps of what a view sees of a light's plain map alone: a trapezoid, or a rectangle, around it becomes the whole map.
#include <array>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/seen_part.hpp"

namespace gnomon {

/// How a map is warped: texels grow along a way in its plane. With `strength` k and t from 0 at the near end of what is
/// seen to 1 at its far end, w = 1 + k t: a texel is w times as wide at t as at the near end, and w^2 times as long.
struct Warp {
    glm::dvec2 away{1.0, 0.0}; ///< Unit.
    double strength = 0.0;     ///< 0: all texels are of one size.
};

/// A trapezoid whose parallel sides lie across `away`, and the projective map that makes it a square. Its other two
/// sides meet where w is 0.
struct Trapezoid {
    std::array<glm::dvec2, 4> corners; ///< Near left, near right, far right, far left.
    glm::dmat3 map; ///< (x, y, 1) of the plane to the square: corners to (-1, -1), (1, -1), (1, 1), (-1, 1).
};

/// The narrowest one of a warp around points; they span an area.
Trapezoid trapezoidAround(std::span<const glm::dvec2> points, const Warp& warp);

/// The fit of the one of some warps that puts the smallest texels, by meanTexel(), where receivers may be. Where none
/// has texels clearly smaller than the plain map's, that one stays, as where nothing is seen. So the map changes over
/// where both are equally fine.
///
/// The hull of `part`, with `borderTexels` around it for filters, is all of the map.
LightFit fitWarped(const LightFit& plain, const SeenPart& part, std::span<const Warp> warps, std::uint32_t resolution,
                   float borderTexels);

/// The way along which the smallest rectangle around a convex polygon lies, unit. It has a side on one of the polygon's
/// (Freeman and Shapira 1975).
glm::dvec2 smallestRectangle(std::span<const glm::dvec2> polygon);

/// The map of fitDepthMap() with all texels in the smallest rectangle around what the view sees of it; memory from the
/// arena.
const LightFit* fitSeenMap(Clamped clamped, const ShadowTask& task, std::uint32_t resolution, FrameArena& arena,
                           std::uint32_t borderTexels = kMapBorderTexels);

/// Strength with which the first `focus` of a trapezoid's length gets 80 % of the map's: the "80 % rule" of Martin and
/// Tan 2004, whose one-dimensional projection has its centre q = l d (1 + x) / (l - 2 d - l x) before the near side,
/// for x = -0.6, a trapezoid of length l and d = focus l; the strength is l / q = 4 / focus - 5. 0 from 0.8 on.
double focusStrength(double focus);

} // namespace gnomon
