// The receiver behind this fragment as a map sees it: a plane, so that every texel is compared at its own centre.
// The includer declares `MapConstants constants` (binding 0), `depthImage` (binding 2) and `normalImage` (binding 3).
#ifndef GNOMON_MAPS_MAP_RECEIVER_GLSL
#define GNOMON_MAPS_MAP_RECEIVER_GLSL
#include "map_lookup.h"
#include "seen_normal.glsl"

layout(constant_id = 0) const bool HAS_NORMALS = true;

struct PlaneReceiver {
    vec3 fromLight;    // metres; only for lights with a position
    vec3 normalWs;   // unit, or from depth differences any length
    float w;         // linear depth
    float depth;     // the depth value
    vec3 ray;        // receiverRayWs()
    float offset;    // metres towards the light, along the normal
    float facing;    // n . (away from the light): negative where it faces the light
    bool decided;    // no caster matters: `visibility` is the answer
    float visibility;
};

// viewRay: through the pixel's centre.
PlaneReceiver fetchPlaneReceiver(ViewConstants view, MapLookup look, vec3 viewRay)
{
    PlaneReceiver r;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    r.depth = texelFetch(depthImage, pixel, 0).x;
    bool exists = r.depth != view.skyDepth;
    r.w = exists ? linearDepth(view, r.depth) : 1.0;
    r.ray = receiverRayWs(view, viewRay, r.depth);
    r.fromLight = look.eyeFromLight.xyz + r.w * r.ray;
    r.normalWs = HAS_NORMALS ? texelFetch(normalImage, pixel, 0).xyz : seenNormal(view, look.area, pixel, r.depth, r.ray);
    r.offset = look.offset.x + r.w * (look.offset.y + r.w * look.offset.z);
    r.facing = dot(r.normalWs, r.fromLight * look.positional + look.axisWs.xyz);
    bool reached = exists && reaches(r.fromLight, look.cone, look.eyeFromLight.w);
    r.decided = !reached || r.facing >= 0.0;
    r.visibility = reached ? 0.0 : 1.0;
    return r;
}

// It in the map's clip space. rayClip: clipFromRay of its view ray.
vec4 receiverClip(MapLookup look, PlaneReceiver r, vec4 rayClip)
{
    return look.clipOfEye + r.w * (rayClip + r.depth * look.clipOfDepth);
}
#endif
