#pragma once
// A light with a surface as the mean of many lights without: a depth map for each of n x n points of it.
//
// Source:    Heckbert and Herf 1997, "Simulating soft shadows with graphics hardware"; Macedo 2018, 6.1 (uniform).
// Reads:     caster geometry, receiver depth and normals.    Writes: visibility.
// Strong at: right penumbrae of any width, of several casters too; rectangles as they are.
// Weak at:   price: every point takes a map, whatever of the picture is penumbra.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kAreaLight;

} // namespace gnomon
