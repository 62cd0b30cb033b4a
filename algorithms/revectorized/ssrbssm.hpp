#pragma once
// Soft shadows of lights with a radius: the shadow that revectorized edges give is blurred on the screen, as widely as
// the blockers around a receiver ask for.
// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 5.4.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: narrow penumbrae in coarse maps; wide ones without grain.
// Weak at:   shadows whose edge is not on the screen; several casters.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kSsrbssm;

} // namespace gnomon
