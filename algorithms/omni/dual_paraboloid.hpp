#pragma once
// Two paraboloid maps around a point light: the lower and the upper half space, each drawn in one pass.
// Source:    S. Brabec, T. Annen, H.-P. Seidel, "Shadow mapping for hemispherical and omnidirectional light sources",
//            CGI 2002; Navratil 2015, 3.3.2 and 3.3.3 (leaving a half out by its cutting plane).
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: point lights over large views: two passes and a third of a cube map's memory.
// Weak at:   coarse casters near the light, which are cut on the CPU whenever they or the light move.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kDualParaboloid;

} // namespace gnomon
