// The receiver behind this fragment as a map sees it: a plane, so that every texel is compared at its own centre.
// The includer declares `MapConstants constants` (binding 0), `depthImage` (binding 2) and `normalImage` (binding 3).
#ifndef GNOMON_MAPS_MAP_RECEIVER_GLSL
#define GNOMON_MAPS_MAP_RECEIVER_GLSL
#include "map_look.h"

layout(constant_id = 0) const bool HAS_NORMALS = true;

struct PlaneReceiver {
    vec3 fromLight;    // metres; only for lights with a position
    vec3 normalWs;   // unit, or from depth differences any length
    float w;         // linear depth
    float offset;    // metres towards the light, along the normal
    float facing;    // n . (away from the light): negative where it faces the light
    bool decided;    // no caster matters: `visibility` is the answer
    float visibility;
};

// Of a step to the next pixel, what a surface seen head-on has: for an axis along which there is no other pixel.
vec3 headOn(vec3 step, vec3 ray)
{
    return step - dot(step, ray) / dot(ray, ray) * ray;
}

// Without normals from the host: the plane through the neighbours that lie closer in depth, turned to the eye.
vec3 normalFromDepth(ViewConstants view, ivec2 pixel, float w, vec3 ray)
{
    ivec2 last = ivec2(constants.map.area.xy + constants.map.area.zw) - 1;
    ivec2 first = ivec2(constants.map.area.xy);
    vec3 side[4];
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i == 0 ? -1 : i == 1 ? 1 : 0, i == 2 ? -1 : i == 3 ? 1 : 0);
        ivec2 at = clamp(pixel + step, first, last);
        float neighbour = min(linearDepth(view, texelFetch(depthImage, at, 0).x), 1e15);
        side[i] = neighbour * viewRayWs(view, vec2(at) + 0.5) - w * ray;
        // A neighbour off the image is this pixel itself: never the closer one.
        if (at == pixel) side[i] = vec3(1e15);
    }
    vec3 dx = dot(side[0], side[0]) < dot(side[1], side[1]) ? -side[0] : side[1];
    vec3 dy = dot(side[2], side[2]) < dot(side[3], side[3]) ? -side[2] : side[3];
    if (first.x == last.x) dx = headOn(view.rayDxWs.xyz, ray);
    if (first.y == last.y) dy = headOn(view.rayDyWs.xyz, ray);
    vec3 normal = normalize(cross(dx, dy));
    return dot(normal, ray) > 0.0 ? -normal : normal;
}

PlaneReceiver fetchPlaneReceiver(ViewConstants view, MapLook look, vec3 rayWs)
{
    PlaneReceiver r;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    bool exists = depth != view.skyDepth;
    r.w = exists ? linearDepth(view, depth) : 1.0;
    r.fromLight = look.eyeFromLight.xyz + r.w * rayWs;
    r.normalWs = HAS_NORMALS ? texelFetch(normalImage, pixel, 0).xyz : normalFromDepth(view, pixel, r.w, rayWs);
    r.offset = look.offset.x + r.w * (look.offset.y + r.w * look.offset.z);
    r.facing = dot(r.normalWs, r.fromLight * look.positional + look.axisWs.xyz);
    bool reached = exists && reaches(r.fromLight, look.cone, look.eyeFromLight.w);
    r.decided = !reached || r.facing >= 0.0;
    r.visibility = reached ? 0.0 : 1.0;
    return r;
}
#endif
