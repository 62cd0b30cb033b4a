#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// A depth map answers where the texels around a receiver agree; where they do not, shadow volumes are counted.
/// Source:    E. Chan and F. Durand, "An efficient hybrid shadow rendering algorithm", EGSR 2004; Rautenbach 2008, 3.4.
/// Reads:     casters' triangles and topology, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: exact edges from a coarse map, without rays; it may be recorded. Volumes fill few pixels.
/// Weak at:   what is thinner than a texel may be missed; map, look-up and volumes are all paid for.
extern const AlgorithmEntry kChanDurand;

} // namespace gnomon
