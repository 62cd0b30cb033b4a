#pragma once
// A depth map answers where its four nearest texels agree; the pixels where they do not are traced on the CPU.
// Source:    S. Beister, M. Ernst, M. Stamminger, "A hybrid GPU-CPU renderer", VMV 2005; Morais 2015, 3.4.1 and 6.
// Reads:     casters' triangles, receiver depth and normals (also read back).     Writes: visibility.
// Strong at: shadow edges as sharp as ray-traced ones at the price of a map and a few percent of the rays.
// Weak at:   four texels can agree and be wrong: what is thinner than a texel may be missed.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kPcfHybrid;

} // namespace gnomon
