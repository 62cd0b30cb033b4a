// The conventions, stated once.
//
//   column vectors, column-major matrices: clip = clipFromWorld * vec4(world, 1)
//   world     metres, relative to an origin that follows the eye in steps of 1024 m (float is enough there)
//   screen    pixel centres at +0.5, first row on top, as Vulkan rasterises
//   light     depth in light space: 0 near, 1 far; cleared to 1
//   visibility 1 = lit, 0 = umbra; 1 where the light does not reach, 0 where the surface faces away from it
#ifndef GNOMON_SHARED_CONVENTIONS_H
#define GNOMON_SHARED_CONVENTIONS_H
#include "types.h"

GN_SHARED_BEGIN

// GnLightType, as the shaders see it.
GN_SHARED_CONST uint LIGHT_DIRECTIONAL = 0u;
GN_SHARED_CONST uint LIGHT_SPOT = 1u;
GN_SHARED_CONST uint LIGHT_POINT = 2u;

// 0 < n.l < GRAZING: counted apart. Residual disagreements between exact methods all lie there.
GN_SHARED_CONST float GRAZING = 0.03f;

GN_SHARED_END
#endif
