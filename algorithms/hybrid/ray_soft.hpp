#pragma once
// A few rays a pixel and frame to the surface of a light, and a filter over pixels and frames.
// Source:    R. L. Cook, T. Porter, L. Carpenter, "Distributed ray tracing", SIGGRAPH 1984; the filter after C. Schied
// et
//            al., "Spatiotemporal variance-guided filtering", HPG 2017, and D. Zhdan, "Fast denoising with
//            self-stabilizing recurrent blurs", GDC 2020.
// Reads:     receiver depth and normals, acceleration structures of the casters.     Writes: visibility.
// Strong at: penumbrae of lights of any kind, right in contact and far away; converges while nothing moves.
// Weak at:   devices with ray queries only; noise that grows with the penumbra for a few frames after a change.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kRaySoft;

} // namespace gnomon
