#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// A revectorized shadow with penumbrae of lights with a radius: as wide at every edge as the depths beside it say, by
/// distances on the screen.
/// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 5.2.
/// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: wide penumbrae: the price depends on the pixels, not on the width; no light in the umbra.
/// Weak at:   edges that are not seen have no penumbra; shadows that are thinner than their penumbra.
extern const AlgorithmEntry kEdtSoft;

} // namespace gnomon
