#pragma once
// Soft shadows of lights with a surface by rays: 64 cells of the light a pixel, of which about a tenth is traced,
// because a pixel's picture of the light is nearly its neighbour's.
// Source:    M. Agrawala, R. Ramamoorthi, A. Heirich, L. Moll, "Efficient image-based methods for rendering soft
//            shadows", SIGGRAPH 2000, section 4.
// Reads:     receiver depth and normals (read back), caster triangles.     Writes: visibility.
// Strong at: penumbrae as 64 rays find them, whatever overlaps whatever; all kinds of light; hard where there is no
//            radius, exactly.
// Weak at:   several rays a pixel even where nothing casts; one GPU-CPU-GPU round trip; no host-drawn casters.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kCoherenceSampling;

} // namespace gnomon
