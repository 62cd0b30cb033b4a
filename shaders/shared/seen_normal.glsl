// A pixel's normal where the host gives none, from the depths around it. The includer declares `depthImage` (binding 2).
#ifndef GNOMON_SHARED_SEEN_NORMAL_GLSL
#define GNOMON_SHARED_SEEN_NORMAL_GLSL
#include "receiver.h"

bool isDrawn(vec4 area, ivec2 pixel)
{
    return all(greaterThanEqual(pixel, ivec2(area.xy))) && all(lessThan(pixel, ivec2(area.xy + area.zw)));
}

// Depth beside a pixel. Beyond what is drawn the plane goes on, which in depth values is linear.
float besideDepth(vec4 area, ivec2 pixel, ivec2 step, float depth)
{
    if (isDrawn(area, pixel + step)) return texelFetch(depthImage, pixel + step, 0).x;
    return isDrawn(area, pixel - step) ? 2.0 * depth - texelFetch(depthImage, pixel - step, 0).x : depth;
}

vec3 seenStep(ViewConstants view, vec4 area, ivec2 pixel, ivec2 step, float depth, vec3 ray)
{
    float back = besideDepth(area, pixel, -step, depth), on = besideDepth(area, pixel, step, depth);
    return seenStepWs(view, vec2(pixel) + 0.5, vec2(step), back, on, depth, ray);
}

// area: pixels drawn, as in MapLookup. depth: the receiver's; ray: its receiverRayWs().
vec3 seenNormal(ViewConstants view, vec4 area, ivec2 pixel, float depth, vec3 ray)
{
    return seenNormalWs(seenStep(view, area, pixel, ivec2(1, 0), depth, ray),
                        seenStep(view, area, pixel, ivec2(0, 1), depth, ray), lookingWs(view, ray));
}
#endif
