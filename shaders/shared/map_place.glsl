// Where receivers lie in a light's maps, for passes over a view's pixels that ask no texel of them.
// The includer declares `depthImage` (binding 2) and `normalImage` (binding 3).
#ifndef GNOMON_SHARED_MAP_PLACE_GLSL
#define GNOMON_SHARED_MAP_PLACE_GLSL
#include "cube_clip.glsl"
#include "map_lookup.h"

layout(constant_id = 0) const bool HAS_NORMALS = true;
layout(constant_id = 1) const bool CUBE = false; // the maps are the six faces of a cube

struct MapPlace {
    vec2 at;  // 0..1; x < 0: there is no receiver, or no map decides it
    float w;  // of the map's clip space
    uint map; // 0, or the cube's face
};

// Whether a map decides the receiver: the light reaches what is there, and it faces the light.
bool isDecidedByMap(MapLookup look, ivec2 pixel, vec3 fromLight)
{
    if (!reaches(fromLight, look.cone, look.eyeFromLight.w)) return false;
    return !HAS_NORMALS ||
           dot(texelFetch(normalImage, pixel, 0).xyz, fromLight * look.positional + look.axisWs.xyz) < 0.0;
}

// depth, w: the pixel's depth value and linear depth. ray, rayClip: its view ray, and MapLookup::clipFromRay of that.
MapPlace mapPlace(MapLookup look, ViewConstants view, ivec2 pixel, float depth, float w, vec3 ray, vec4 rayClip)
{
    const MapPlace none = MapPlace(vec2(-1.0), 1.0, 0u);
    vec3 fromLight = look.eyeFromLight.xyz + w * receiverRayWs(view, ray, depth);
    if (!isDecidedByMap(look, pixel, fromLight)) return none;
    uint map = CUBE ? cubeFaceOf(fromLight) : 0u;
    vec4 clip = CUBE ? cubeClip(look, fromLight, map) : look.clipOfEye + w * (rayClip + depth * look.clipOfDepth);
    vec2 at = clip.xy / (clip.w * look.side);
    bool inside = clip.w > 0.0 && min(at.x, at.y) >= 0.0 && max(at.x, at.y) < 1.0;
    return MapPlace(inside ? at : vec2(-1.0), clip.w, map);
}
#endif
