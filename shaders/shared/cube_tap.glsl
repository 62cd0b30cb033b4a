// Taps in the six faces around a point light. GLSL and HLSL.
#ifndef GNOMON_SHARED_CUBE_TAP_GLSL
#define GNOMON_SHARED_CUBE_TAP_GLSL
#include "cube.h"
#include "plane_tap.glsl"

// A vector from the light in a face's clip space, x and y in texels times w.
vec4 cubeClip(MapLookup look, vec3 fromLight, uint face)
{
    vec3 local = inCubeFace(face, fromLight);
    vec2 texels = (local.xy / look.slope + local.z) * (0.5 * look.side);
    return vec4(texels, look.depthConstant * local.z + look.depthScale, local.z);
}

// clip: cubeClip() of the receiver.
Tap faceTap(MapLookup look, PlaneReceiver r, vec4 clip, uint face)
{
    vec3 normal = inCubeFace(face, r.normalWs);
    return planarTap(look, r, clip, normal.xy * (2.0 * look.slope / look.side), float(face));
}
#endif
