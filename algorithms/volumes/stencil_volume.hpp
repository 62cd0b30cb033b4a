#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Stencil shadow volumes: silhouettes from CPU or device, counted in the stencil of a copy of the host's depth.
/// Source:    Rautenbach 2008, 3.1; Crow 1977; Heidmann 1991; Everitt and Kilgard 2002. Signed multiplicities:
///            Bergeron 1986; Kim, Kim and Turk 2008.
/// Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes: visibility.
/// Strong at: pixel-exact edges for all kinds of light, open, holed and flipped meshes included.
/// Weak at:   fill where long shadows cross the whole view; casters it sees as triangles only (no alpha test).
extern const AlgorithmEntry kStencilVolume;

} // namespace gnomon
