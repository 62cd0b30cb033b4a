#pragma once
// Two paraboloid maps around a point light whose dense rims meet where the view looks.
// Source:    Navratil 2015, 4.1.4.
// Reads:     triangles of the casters; receiver depth and normals.     Writes: visibility.
// Strong at: lights near the eye: shadows before the camera get three times the texels of dual_paraboloid.
// Weak at:   what lies behind the light gets fewer; the maps follow the view; coarse casters, as dual_paraboloid.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kSkewedParaboloid;

} // namespace gnomon
