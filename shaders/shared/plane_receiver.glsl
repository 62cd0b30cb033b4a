// A receiver as a map sees it: a plane, so that every texel is compared at its own centre. GLSL and HLSL.
#ifndef GNOMON_SHARED_PLANE_RECEIVER_GLSL
#define GNOMON_SHARED_PLANE_RECEIVER_GLSL
#include "map_look.h"

struct PlaneReceiver {
    vec3 fromLight;  // metres; only for lights with a position
    vec3 normalWs;   // unit, or from depth differences any length
    float w;         // linear depth
    float depth;     // the depth value
    vec3 ray;        // from the eye to the receiver, over w
    float offset;    // metres towards the light, along the normal
    float facing;    // n . (away from the light): negative where it faces the light
    bool decided;    // no caster matters: `visibility` is the answer
    float visibility;
};

// With what the light alone says of it, where fromLight, normalWs and w are known.
PlaneReceiver seenByLight(MapLookup look, PlaneReceiver r, bool exists)
{
    r.offset = look.offset.x + r.w * (look.offset.y + r.w * look.offset.z);
    r.facing = dot(r.normalWs, r.fromLight * look.positional + look.axisWs.xyz);
    bool reached = exists && reaches(r.fromLight, look.cone, look.eyeFromLight.w);
    r.decided = !reached || !(r.facing < 0.0); // nor does a normal that is no number
    r.visibility = reached ? 0.0 : 1.0;
    return r;
}

// It in the map's clip space. rayClip: clipFromRay of its view ray.
vec4 receiverClip(MapLookup look, PlaneReceiver r, vec4 rayClip)
{
    return look.clipOfEye + r.w * (rayClip + r.depth * look.clipOfDepth);
}
#endif
