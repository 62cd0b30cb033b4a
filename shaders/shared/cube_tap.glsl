// Taps in the six faces around a point light. GLSL and HLSL.
#ifndef GNOMON_SHARED_CUBE_TAP_GLSL
#define GNOMON_SHARED_CUBE_TAP_GLSL
#include "cube_clip.glsl"
#include "plane_tap.glsl"

// clip: cubeClip() of the receiver.
Tap faceTap(MapLookup look, PlaneReceiver r, vec4 clip, uint face)
{
    vec3 normal = inCubeFace(face, r.normalWs);
    return planarTap(look, r, clip, normal.xy * (2.0 * look.slope / look.side), float(face));
}
#endif
