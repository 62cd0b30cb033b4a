#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// A directional light's maps of slices of the view, fine near the eye, before one of all that casts.
/// Source:    F. Zhang, H. Sun, L. Xu and L. Lun, "Parallel-split shadow maps for large-scale virtual environments",
/// 2006. Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility. Strong
/// at: wide scenes; near shadows keep their quality however far the casters reach. Weak at:   several maps to draw,
/// those of slices anew when the camera has moved on; one set per view.
extern const AlgorithmEntry kCascades;

} // namespace gnomon
