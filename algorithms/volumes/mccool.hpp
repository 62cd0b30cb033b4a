#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Shadow volumes rebuilt from depth maps: polygons where depth jumps, one bit of stencil a map that they toggle.
/// Source:    M. McCool, "Shadow volume reconstruction from depth maps", ACM TOG 19(1), 2000; Rautenbach 2008, 3.3.1.
/// Reads:     casters, host-drawn ones included, as a depth map; receiver depth and normals.     Writes: visibility.
/// Strong at: volumes of whatever can be drawn, without its triangles; they and the map are kept while nothing moves.
/// Weak at:   as coarse as the map, and dearer than looking it up.
extern const AlgorithmEntry kMccool;

} // namespace gnomon
