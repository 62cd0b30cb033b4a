#pragma once
// Shadow map in which every row of texels, and then every column, is spread by the receivers that lie in it, so that
// each texel holds about as many.
// Source:    J. Navratil, "High-quality shadow rendering from complex light sources", 2015, 4.2.
// Reads:     casters' triangles; receiver depth and normals.     Writes: visibility.
// Strong at: receivers in several places of the map, with little between them.
// Weak at:   texels are sheared; the map is drawn in every frame, more slowly than a plain one.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kNonorthogonalWarp;

} // namespace gnomon
