#pragma once
// Whole tiles of receivers against whole casters: a tile whose shaft to the light meets nothing is lit, one that lies
// in the shadow of a single triangle is dark, and what neither proves is split, at last into single pixels and rays.
// Source:    gnomon's own; shafts: E. Haines, J. Wallace, "Shaft culling for efficient ray-cast radiosity", 1991.
// Reads:     receiver depth and normals (read back), caster triangles and their trees.     Writes: visibility.
// Strong at: the picture of ray_traced with a fraction of its rays, whatever moves: no map, nothing kept.
// Weak at:   finely tessellated casters in shadow of themselves; one GPU-CPU-GPU round trip; no host-drawn casters.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kTileShafts;

} // namespace gnomon
