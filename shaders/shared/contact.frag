#version 460
// Darkens what the depth image itself shows to be hidden from the light, within a short way: a ray that starts at the
// receiver gets behind a surface that is seen. What is not seen hides nothing.
#extension GL_GOOGLE_include_directive : require
#include "contact.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    ContactConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(location = 0) out float visibility;
layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "soft_surface.glsl"

// A place on the ray, and whether a surface seen lies just before it: by no more than the ray went since the place before,
// so that what stands far in front does not hide the light. The receiver's own plane hides nothing.
bool isBehind(Surface surface, vec3 placeOnRayWs, float stepWs)
{
    vec2 drawn = drawnAt(constants.view, constants.area, placeOnRayWs);
    if (!isInside(constants.area, drawn)) return false;
    ivec2 tap = ivec2(drawn);
    float depth = texelFetch(depthImage, tap, 0).x;
    if (depth == constants.view.skyDepth) return false;
    vec3 seenWs = placeWs(constants.view, tap, depth);
    if (!(dot(surface.normalWs, seenWs - surface.atWs) > surface.pixelWs)) return false;
    vec3 looking = lookingWs(constants.view, viewRayWs(constants.view, vec2(tap) + 0.5));
    float behind = dot(placeOnRayWs - seenWs, looking) / max(length(looking), 1e-20);
    return behind > 0.5 * surface.pixelWs && behind < 2.0 * (stepWs + surface.pixelWs);
}

bool isHidden(Surface surface, vec3 toLight, float lengthWs)
{
    vec3 startWs = surface.atWs + surface.pixelWs * surface.normalWs;
    // No more than a place a pixel.
    float steps = clamp(ceil(lengthWs / max(surface.pixelWs, 1e-20)), 1.0, float(MAX_CONTACT_STEPS));
    float stepWs = lengthWs / steps;
    for (float i = 1.0; i <= steps; i += 1.0) // bound: MAX_CONTACT_STEPS
        if (isBehind(surface, startWs + i * stepWs * toLight, stepWs)) return true;
    return false;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (texelFetch(depthImage, pixel, 0).x == constants.view.skyDepth) discard;
    Surface surface = surfaceAt(constants.view, constants.area, pixel);
    vec3 toLight = towardsLightWs(constants.light, surface.atWs);
    if (!(dot(surface.normalWs, toLight) > 0.0) || !lightReaches(constants.light, surface.atWs)) discard;
    float distance = length(constants.light.positionWs.xyz - surface.atWs);
    float lengthWs = constants.light.type == LIGHT_DIRECTIONAL ? constants.lengthWs : min(constants.lengthWs, distance);
    if (!isHidden(surface, toLight, lengthWs)) discard;
    visibility = 0.0;
}
