#pragma once
// Trapezoidal shadow map: the trapezoid around what the view sees of a light's map becomes the whole map, 80 % of its
// length for what is near.
// Source:    T. Martin, T.-S. Tan, "Anti-aliasing and continuity with trapezoidal shadow maps", EGSR 2004.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: views across the light, close to what they look at.
// Weak at:   views along the light; cameras that move, since texels move with them.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kTrapezoidal;

} // namespace gnomon
