#pragma once
// Shadow maps whose depths are filtered once, before they are compared: VSM, ESM, EVSM and MSM.
// Source:    W. Donnelly and A. Lauritzen, "Variance shadow maps", I3D 2006; T. Annen et al., "Exponential shadow
// maps",
//            GI 2008; A. Lauritzen, thesis, Waterloo 2008 (EVSM); C. Peters and R. Klein, "Moment shadow mapping", I3D
//            2015.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: wide even edges at a price that does not depend on their width, and next to none while nothing moves.
// Weak at:   light bleeds where casters overlap along a ray, and along contacts.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kMoments;

} // namespace gnomon
