#pragma once
// Six shadow maps around a point light, drawn face by face: only the faces a visible receiver can lie in, each with the
// casters in its pyramid.
// Source:    Navratil 2015, 3.3.1 and 3.3.3; G. King and W. Newhall, "Efficient omnidirectional shadow maps",
//            ShaderX3, 2005 (which faces and casters matter).
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: point lights near many triangles; even error all around, none at the seams.
// Weak at:   six times the memory of one map, and up to six times the clears.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kCubeMap;

} // namespace gnomon
