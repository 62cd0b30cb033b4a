#pragma once
// A light with a surface as the mean of depth maps from points of it, as many as the picture needs: squares of the
// source are divided where pixels would show a step.
//
// Source:    Schwarzler, Mattausch, Scherzer and Wimmer 2012; Macedo 2018, 6.1 (the rule of plateaus).
// Reads:     caster geometry, receiver depth and normals.    Writes: visibility.
// Strong at: narrow penumbrae: a handful of maps where area_light takes all.
// Weak at:   four round trips to the CPU; wide penumbrae that fill the picture take all 289 maps.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kAreaAdaptive;

} // namespace gnomon
