#pragma once
// area_adaptive from fewer points: what one hides ends in a ramp about a line, as wide as the gap to the next point's
// edge, and pixels on ramps show no step.
//
// Source:    Macedo 2018, chapter 6.
// Reads:     caster geometry, receiver depth and normals.    Writes: visibility.
// Strong at: smooth penumbrae from a tenth of area_light's maps.
// Weak at:   four round trips to the CPU; casters at several depths before one receiver.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kAreaRevectorized;

} // namespace gnomon
