#pragma once
// One ray a pixel on the CPU, or many to a light with a radius: the truth that every other method is held against.
// Source:    A. Appel, "Some techniques for shading machine renderings of solids", AFIPS 1968; Morais 2015, 2.3.
// Reads:     receiver depth and normals (read back), caster triangles.     Writes: visibility.
// Strong at: exact for every kind of light and caster with triangles; alpha-tested casters by the host's opacity.
// Weak at:   cost follows the pixels that face the light, one GPU-CPU-GPU round trip; no host-drawn casters.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kRayTraced;

} // namespace gnomon
