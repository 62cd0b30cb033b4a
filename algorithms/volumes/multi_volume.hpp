#pragma once
// A light with a surface as the mean of many lights without: volumes are counted from each of n x n points of it.
//
// Source:    Brotman and Badler 1984, "Generating soft shadows with a depth buffer algorithm".
// Reads:     caster triangles with topology, receiver depth and normals.    Writes: visibility.
// Strong at: right penumbrae of any width, of several casters too, without texels; no work on the CPU for a point.
// Weak at:   price: every point draws all volumes, which fill the view; penumbrae have as many steps as points.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kMultiVolume;

} // namespace gnomon
