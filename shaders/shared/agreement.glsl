// Where a depth map can be believed: the texels around a receiver vote, each compared at its own centre on the
// receiver's plane. With MAP_LAYERS the map is the six faces around a point light. For the includer: planar_tap.glsl.
#ifndef GNOMON_MAPS_AGREEMENT_GLSL
#define GNOMON_MAPS_AGREEMENT_GLSL
#include "verdict.glsl"
#ifdef MAP_LAYERS
#include "cube_tap.glsl"
#endif

// The receiver in the map's clip space: x and y in texels. layer: the face it falls into.
vec4 mapClipOf(PlaneReceiver r, out float layer)
{
    MapLookup look = constants.map;
#ifdef MAP_LAYERS
    uint face = cubeFaceOf(r.fromLight);
    layer = float(face);
    return cubeClip(look, r.fromLight, face);
#else
    layer = 0.0;
    return receiverClip(look, r, rayClip);
#endif
}

Tap tapOf(PlaneReceiver r, vec4 clip, float layer)
{
#ifdef MAP_LAYERS
    return faceTap(constants.map, r, clip, uint(layer));
#else
    return matrixTap(constants.map, r, clip);
#endif
}
#endif
