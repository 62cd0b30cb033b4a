#pragma once
// conservative_map whose shrunken layer knows which triangles go together: shadows tear at silhouettes only.
// Source:    F. Morais, "Rasterization + Ray Tracing: Rendering of Hard Shadows", Universidade do Minho 2015, 4
// (CRSMA).
//            Differs: its kept edges claim texels that are not covered, so by default a texel counts as covered by the
//            sheet over its centre unless a silhouette edge touches it.
// Reads:     casters' triangles and topology, receiver depth and normals (also read back).     Writes: visibility.
// Strong at: exact, with a part of the rays of conservative_map: the inside of shadows is known.
// Weak at:   silhouettes close together leave no texel untouched; three more passes over the casters when they move.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kConservativeMapAdjacency;

} // namespace gnomon
