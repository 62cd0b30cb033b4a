#pragma once
// One ray a pixel on the device: the answers of ray_traced without the CPU.
// Source:    A. Appel, "Some techniques for shading machine renderings of solids", AFIPS 1968; VK_KHR_ray_query.
// Reads:     receiver depth and normals, acceleration structures of the casters.     Writes: visibility.
// Strong at: exact for every kind of light, nothing waits for the CPU, so that it may be recorded.
// Weak at:   devices with ray queries only; no host-drawn casters and none that are alpha-tested by a function.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kRayQuery;

} // namespace gnomon
