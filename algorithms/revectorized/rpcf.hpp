#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Percentage-closer filtering of a depth map whose edges are lines: penumbrae of a fixed width, without the stairs and
/// steps that a map's texels make of them.
/// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 4.1.2.
/// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: even ramps from coarse maps.
/// Weak at:   cost; what is thinner than a texel.
extern const AlgorithmEntry kRpcf;

} // namespace gnomon
