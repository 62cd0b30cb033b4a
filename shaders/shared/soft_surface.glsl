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
    vec4 heights;  // along the normal, from the eye: of viewRayWs() at pixel (0, 0), per pixel to the right and down, and of
                   // rayDepthWs
    float height;  // of the surface
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
    vec3 n = surface.normalWs;
    surface.heights = vec4(dot(n, view.rayCornerWs.xyz), dot(n, view.rayDxWs.xyz), dot(n, view.rayDyWs.xyz),
                           dot(n, view.rayDepthWs.xyz));
    surface.height = dot(n, surface.atWs - view.eyeWs.xyz);
    return surface;
}

// How far a point lies off the surface's plane, metres.
float offPlane(Surface surface, vec3 pointWs)
{
    return abs(dot(surface.normalWs, pointWs - surface.atWs));
}

// offPlane() of what a pixel of the same view sees.
float offPlaneAt(ViewConstants view, Surface surface, ivec2 pixel)
{
    float depth = texelFetch(depthImage, pixel, 0).x;
    float ray = dot(surface.heights, vec4(1.0, vec2(pixel) + 0.5, depth));
    return abs(linearDepth(view, depth) * ray - surface.height);
}

// How near what a tap sees lies to the surface's plane: 1 on it, 0 a pixel and a tenth of the filter's radius away from it.
// radius: metres
float nearness(ViewConstants view, Surface surface, ivec2 tap, float radius)
{
    return max(1.0 - offPlaneAt(view, surface, tap) / (surface.pixelWs + 0.1 * radius), 0.0);
}

// How much what a tap sees says of the surface: it lies on its plane, and faces the same way.
float likeness(ViewConstants view, Surface surface, ivec2 tap, float radius)
{
    float weight = nearness(view, surface, tap, radius);
    if (HAS_NORMALS) {
        vec3 texel = texelFetch(normalImage, tap, 0).xyz;
        float along = max(dot(surface.normalWs, texel), 0.0);
        float squared = along * along / max(dot(texel, texel), 1e-20);
        weight *= squared * squared;
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
