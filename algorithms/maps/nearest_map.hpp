#pragma once
// Shadow map of directional and spot lights, compared at the nearest texel: the smallest algorithm there can be.
// Source:    L. Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: little to read.
// Weak at:   shadow edges are stairs of texels.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kNearestMap;

} // namespace gnomon
