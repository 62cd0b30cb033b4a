#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// A depth map whose shadow edges are followed along their stairs of texels and replaced by lines.
/// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 3
/// and 4.1.1. Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: long, straight edges in coarse maps; nothing is stored beside the map.
/// Weak at:   what is thinner than a texel; round casters of few texels, whose corners are cut.
extern const AlgorithmEntry kRbsm;

} // namespace gnomon
