#pragma once
// Points of a light with a surface, and the light as it shines from one of them.
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// The world axis along which a direction goes least; the first of equals.
glm::vec3 axisAcross(glm::vec3 direction);

/// From the square [-1, 1]^2 to the unit disc, equal areas to equal areas and squares about the centre to circles.
/// Source: P. Shirley and K. Chiu, "A low distortion map between disk and square", Journal of Graphics Tools 2(3),
/// 1997.
glm::vec2 discOfSquare(glm::vec2 square);

/// Point i of side^2 that are spread over the square [-1, 1]^2: one in each of side x side squares, and one in each of
/// side^2 rows and columns, so that an edge along the square's sides crosses them one by one.
/// Source: A. Kensler, "Correlated Multi-Jittered Sampling", Pixar Technical Memo 13-01, 2013, section 2 (without the
/// jitter).
glm::vec2 spreadPoint(std::uint32_t i, std::uint32_t side);

/// Point i of `count` that are spread over the unit disc, as seeds in a sunflower: however an edge lies, the share of
/// points on one side of it is near that of the area.
/// Source: H. Vogel, "A better way to construct the sunflower head", Mathematical Biosciences 44, 1979.
glm::vec2 sunflowerPoint(std::uint32_t i, std::uint32_t count);

/// A point of a source.
struct SourcePoint {
    glm::vec2 at;        ///< Of a rectangle in the square [-1, 1]^2, of other sources in the unit disc.
    float height = 0.5f; ///< Of a sphere, in [0, 1): where along its axis. The cosine of a half turn of that is even.
};

/// Point i of side^2 that cover a light's source evenly.
SourcePoint spreadOver(const LightView& light, std::uint32_t i, std::uint32_t side);
/// The point at a place of the square [-1, 1]^2. @param i a number of its own among the points
SourcePoint pointAt(const LightView& light, glm::vec2 square, std::uint32_t i);

/// The light at one point of its source, as a light without a surface, for receivers that the whole light reaches. Of a
/// sphere these are points within it that cover the disc evenly which it turns to a receiver, wherever that is. A
/// spot's cone is widened: it holds what the light's own cone does from `nearest` on.
/// @param nearest metres from the light to the nearest caster
LightView lightAt(const LightView& light, SourcePoint point, float nearest = 0.0f);

} // namespace gnomon
