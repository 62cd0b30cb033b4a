#pragma once
// Soft shadows of lights with a radius from their depth map: the blockers around a receiver say how wide the penumbra
// is there, and as many texels are filtered.
// Source:    R. Fernando, "Percentage-closer soft shadows", SIGGRAPH 2005 sketches; G. Guennebaud, L. Barthe, M.
//            Paulin, "Real-time soft shadow mapping by backprojection", EGSR 2006 (nearest and farthest depths).
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: penumbrae that widen with the distance from the caster, for the price of a map; all kinds of light.
// Weak at:   casters at several depths before one receiver; noise in wide penumbrae; edges as fine as texels are.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kPcss;

} // namespace gnomon
