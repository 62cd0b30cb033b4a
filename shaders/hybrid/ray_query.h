// How rays on the device look at a light.
#ifndef GNOMON_HYBRID_RAY_QUERY_H
#define GNOMON_HYBRID_RAY_QUERY_H
#include "../shared/receiver.h"

GN_SHARED_BEGIN

// std140 and std430 alike.
struct RayQueryConstants {
    ViewConstants view;
    LightConstants light;
    vec4 area;      // pixels drawn: x, y, width, height
    uvec4 lightMask; // x: casters whose mask meets it cast; bytes of visibility, y: of what is lit, z: of what is dark
};
GN_SHARED_OFFSET(RayQueryConstants, area, 224)
GN_SHARED_SIZE(RayQueryConstants, 256)

GN_SHARED_END
#endif
