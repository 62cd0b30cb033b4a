// A place around a point light in its cube's faces. GLSL and HLSL.
#ifndef GNOMON_SHARED_CUBE_CLIP_GLSL
#define GNOMON_SHARED_CUBE_CLIP_GLSL
#include "cube.h"
#include "map_look.h"

// A vector from the light in a face's clip space, x and y in texels times w.
vec4 cubeClip(MapLookup look, vec3 fromLight, uint face)
{
    vec3 local = inCubeFace(face, fromLight);
    vec2 texels = (local.xy / look.slope + local.z) * (0.5 * look.side);
    return vec4(texels, look.depthConstant * local.z + look.depthScale, local.z);
}
#endif
