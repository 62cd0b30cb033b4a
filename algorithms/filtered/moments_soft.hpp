#pragma once
// Soft shadows of lights with a radius from summed-area tables of moments: VSSM and MSSM.
// Source:    B. Yang, Z. Dong, J. Feng, H.-P. Seidel and J. Kautz, "Variance soft shadow mapping", CGF 29, 2010;
//            C. Peters, C. Muenstermann, N. Wetzstein and R. Klein, "Beyond hard shadows: moment shadow maps for single
//            scattering, soft shadows and translucent occluders", I3D 2016.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: penumbrae that widen with distance, at a price that does not depend on their width.
// Weak at:   light leaks where casters overlap; one caster before another widens the other's penumbra.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kMomentsSoft;

} // namespace gnomon
