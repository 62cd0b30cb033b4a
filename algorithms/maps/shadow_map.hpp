#pragma once
// Shadow map of directional and spot lights, compared at the nearest texel or averaged over a box of texels (PCF).
// Source:    L. Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978; W. Reeves, D. Salesin, R. Cook,
//            "Rendering antialiased shadows with depth maps", SIGGRAPH 1987.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: many triangles, many lights; anything the host can draw casts.
// Weak at:   shadow edges are as fine as texels are.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kShadowMap;

} // namespace gnomon
