// Where a depth map can be believed: the texels around a receiver vote, each compared at its own centre on the
// receiver's plane. With MAP_LAYERS the map is the six faces around a point light. For the includer: planar_tap.glsl.
#ifndef GNOMON_MAPS_AGREEMENT_GLSL
#define GNOMON_MAPS_AGREEMENT_GLSL
#include "verdict.glsl"
#ifdef MAP_LAYERS
#include "cube.h"
#endif

// The receiver in the map's clip space: x and y in texels. layer: the face it falls into.
vec4 mapClipOf(PlaneReceiver r, out float layer)
{
    MapLookup look = constants.map;
#ifdef MAP_LAYERS
    uint face = cubeFaceOf(r.fromLight);
    vec3 local = inCubeFace(face, r.fromLight);
    vec2 texels = (local.xy / look.slope + local.z) * (0.5 * look.side);
    layer = float(face);
    return vec4(texels, look.depthConstant * local.z + look.depthScale, local.z);
#else
    layer = 0.0;
    return receiverClip(look, r, rayClip);
#endif
}

Tap tapOf(PlaneReceiver r, vec4 clip, float layer)
{
    MapLookup look = constants.map;
#ifdef MAP_LAYERS
    vec3 normal = inCubeFace(uint(layer), r.normalWs);
    vec2 normalPerTexel = normal.xy * (2.0 * look.slope / look.side);
#else
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
#endif
    return planarTap(look, r, clip, normalPerTexel, layer);
}
#endif
