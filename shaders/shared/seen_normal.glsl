// A pixel's normal where the host gives none, from the depths around it. The includer declares `depthImage` (binding 2).
#ifndef GNOMON_SHARED_SEEN_NORMAL_GLSL
#define GNOMON_SHARED_SEEN_NORMAL_GLSL
#include "receiver.h"

// Of a step to the next pixel, what a surface seen head-on has: for an axis along which there is no other pixel.
vec3 headOn(vec3 step, vec3 ray)
{
    return step - dot(step, ray) / dot(ray, ray) * ray;
}

vec3 stepTo(ViewConstants view, vec4 area, ivec2 beside, float w, vec3 ray)
{
    bool drawn = all(greaterThanEqual(beside, ivec2(area.xy))) && all(lessThan(beside, ivec2(area.xy + area.zw)));
    float depth = drawn ? texelFetch(depthImage, beside, 0).x : view.skyDepth;
    return drawn ? stepWs(view, vec2(beside) + 0.5, depth, w, ray) : vec3(1e15);
}

// area: pixels drawn, as in MapLook. w: the receiver's linear depth. ray: its view ray.
vec3 seenNormal(ViewConstants view, vec4 area, ivec2 pixel, float w, vec3 ray)
{
    vec3 left = stepTo(view, area, pixel - ivec2(1, 0), w, ray), right = stepTo(view, area, pixel + ivec2(1, 0), w, ray);
    vec3 above = stepTo(view, area, pixel - ivec2(0, 1), w, ray), below = stepTo(view, area, pixel + ivec2(0, 1), w, ray);
    if (area.z == 1.0) right = headOn(view.rayDxWs.xyz, ray);
    if (area.w == 1.0) below = headOn(view.rayDyWs.xyz, ray);
    return seenNormalWs(left, right, above, below, ray);
}
#endif
