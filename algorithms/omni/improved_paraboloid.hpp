#pragma once
// One paraboloid around a point light outside the view, aimed at what is seen and cut to it; two halves where the light
// is inside.
// Source:    Navratil 2015, 4.1.1 to 4.1.3.
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: lights beside or behind the view: one pass, and texels spent where the view looks.
// Weak at:   moving cameras: each view has its own map, which follows it. Coarse casters, as dual_paraboloid.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kImprovedParaboloid;

} // namespace gnomon
