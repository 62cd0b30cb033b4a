#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// A revectorized shadow whose edges are ramps of one width in the world, by distances on the screen.
/// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 4.2.
/// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: wide ramps: the price depends on the pixels, not on the width.
/// Weak at:   edges that are not seen have no ramp; lights whose penumbrae grow with the distance (edt_soft).
extern const AlgorithmEntry kEdt;

} // namespace gnomon
