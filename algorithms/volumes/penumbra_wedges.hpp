#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Soft shadows of spherical lights: hard volumes counted from the light's centre, and a wedge under every silhouette
/// edge in which a fragment shader integrates, in closed form, how much of the light's disc the edge covers or
/// uncovers. Source:    Akenine-Moeller and Assarsson 2002; Assarsson and Akenine-Moeller 2003; Rautenbach
/// 2008, 2.4.4.3. Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes:
/// visibility. Strong at: penumbrae that follow light, caster and receiver, without noise and without a map; hard at
/// contacts. Weak at:   casters that overlap (their coverage adds up); silhouettes as the light's centre sees them;
/// fill.
extern const AlgorithmEntry kPenumbraWedges;

} // namespace gnomon
