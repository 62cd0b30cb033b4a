#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Casters flattened onto the one plane that most visible receivers lie on.
/// Source:    J. Blinn, "Me and my (fake) shadow", IEEE CG&A 8(1), 1988; Rautenbach 2008, 2.4.2.
/// Reads:     triangles of the casters, receiver depth, geometric normals. Writes: visibility.
/// Strong at: flat grounds: exact edges for the price of drawing the casters once; needs no topology, no map, no
/// stencil. Weak at:   everything off the plane, which it shows lit wherever it faces the light.
extern const AlgorithmEntry kProjectedPlanar;

} // namespace gnomon
