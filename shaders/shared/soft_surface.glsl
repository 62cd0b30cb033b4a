// The surface behind a pixel as filters compare it with others. The includer declares `depthImage` (binding 2), `normalImage`
// (binding 3), HAS_NORMALS and what seen_normal.glsl wants.
#ifndef GNOMON_SHARED_SOFT_SURFACE_GLSL
#define GNOMON_SHARED_SOFT_SURFACE_GLSL
#include "seen_normal.glsl"

struct Surface {
    vec3 atWs;
    vec3 normalWs; // unit
    float depth;   // the depth value
    float pixelWs; // width of a pixel there, metres
};

vec3 placeWs(ViewConstants view, ivec2 pixel, float depth)
{
    vec3 ray = receiverRayWs(view, viewRayWs(view, vec2(pixel) + 0.5), depth);
    return view.eyeWs.xyz + linearDepth(view, depth) * ray;
}

// A pixel that has a receiver.
Surface surfaceAt(ViewConstants view, vec4 area, ivec2 pixel)
{
    Surface surface;
    surface.depth = texelFetch(depthImage, pixel, 0).x;
    surface.atWs = placeWs(view, pixel, surface.depth);
    surface.pixelWs = linearDepth(view, surface.depth) * view.pixelSize;
    if (HAS_NORMALS) {
        vec3 texel = texelFetch(normalImage, pixel, 0).xyz;
        surface.normalWs = texel / max(length(texel), 1e-20);
    } else {
        vec3 ray = receiverRayWs(view, viewRayWs(view, vec2(pixel) + 0.5), surface.depth);
        surface.normalWs = seenNormal(view, area, pixel, surface.depth, ray);
    }
    return surface;
}

// How far a point lies off the surface's plane, metres.
float offPlane(Surface surface, vec3 pointWs)
{
    return abs(dot(surface.normalWs, pointWs - surface.atWs));
}

// How much what a tap sees says of the surface: it lies on its plane, and faces the same way.
// radius: of the filter, metres
float likeness(ViewConstants view, Surface surface, ivec2 tap, float radius)
{
    vec3 tapWs = placeWs(view, tap, texelFetch(depthImage, tap, 0).x);
    float weight = max(1.0 - offPlane(surface, tapWs) / (surface.pixelWs + 0.1 * radius), 0.0);
    if (HAS_NORMALS) {
        vec3 texel = texelFetch(normalImage, tap, 0).xyz;
        float along = max(dot(surface.normalWs, texel / max(length(texel), 1e-20)), 0.0);
        weight *= along * along * along * along;
    }
    return weight;
}

// Where a point of the world is drawn, in pixels; outside of the area where it is not.
vec2 drawnAt(ViewConstants view, vec4 area, vec3 pointWs)
{
    vec4 clip = view.clipFromWorld * vec4(pointWs, 1.0);
    return clip.w > 0.0 ? area.xy + (clip.xy / clip.w * 0.5 + 0.5) * area.zw : vec2(-1.0);
}

// False for what is no number.
bool isInside(vec4 area, vec2 at)
{
    return all(greaterThanEqual(at, area.xy)) && all(lessThan(at, area.xy + area.zw));
}
#endif
