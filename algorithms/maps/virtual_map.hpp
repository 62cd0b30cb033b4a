#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// A directional or spot light's map in pages of several resolutions, of which those that the view asks for are kept.
/// Source:    ours; clipmaps (C. Tanner, C. Migdal and M. Jones, SIGGRAPH 1998) and adaptive shadow maps (R. Fernando,
/// S. Fernandez, K. Bala and D. Greenberg, SIGGRAPH 2001), in pages.
/// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: wide scenes: texels are about as wide as pixels near and far, and what stands still is drawn once.
/// Weak at:   a camera that turns or jumps draws many small pages; one pool per view.
extern const AlgorithmEntry kVirtualMap;

} // namespace gnomon
