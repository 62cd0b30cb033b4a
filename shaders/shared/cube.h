// The six faces around a point light, as LightFit lays them out: right x down = forward, nothing mirrored.
#ifndef GNOMON_OMNI_CUBE_H
#define GNOMON_OMNI_CUBE_H
#include "types.h"

GN_SHARED_BEGIN

// Face +X, -X, +Y, -Y, +Z, -Z that a direction from the light falls into.
GN_SHARED_FN uint cubeFaceOf(vec3 v)
{
    vec3 size = abs(v);
    uint axis = size.x >= size.y && size.x >= size.z ? 0u : (size.y >= size.z ? 1u : 2u);
    float major = axis == 0u ? v.x : (axis == 1u ? v.y : v.z);
    return 2u * axis + (major < 0.0f ? 1u : 0u);
}

// A vector in the face's axes: right, down, forward.
GN_SHARED_FN vec3 inCubeFace(uint face, vec3 v)
{
    float sign = (face & 1u) == 0u ? 1.0f : -1.0f;
    if (face < 2u) return vec3(sign * v.z, -v.y, sign * v.x);
    if (face < 4u) return vec3(-sign * v.z, -v.x, sign * v.y);
    return vec3(-sign * v.x, -v.y, sign * v.z);
}

GN_SHARED_END
#endif
