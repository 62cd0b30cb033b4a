#pragma once
// Perspective shadow map and light-space perspective shadow map: the light's map is drawn through a perspective that
// follows the view's, so that its texels grow with distance from the eye as pixels do.
// Source:    M. Stamminger, G. Drettakis, "Perspective shadow maps", SIGGRAPH 2002; M. Wimmer, D. Scherzer,
//            W. Purgathofer, "Light space perspective shadow maps", EGSR 2004.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: views across the light over a long way.
// Weak at:   views along the light; cameras that move, since texels move with them.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kPerspectiveWarp;

} // namespace gnomon
