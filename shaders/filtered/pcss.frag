#version 460
// Visibility of a light's disc from its depth map. With MAP_LAYERS the map is the six faces around a point light; with
// HARD the light has no radius (1: of one projection, 2: a point light).
#extension GL_GOOGLE_include_directive : require
#if defined(HARD) && HARD == 2
#define MAP_LAYERS
#endif
#include "pcss.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    float reach;
    float tangentPerTexel;
    uint taps;
    uint early;
    uint reasons;
    float radius;
};
#ifndef HARD
layout(std430, set = 0, binding = 1) readonly buffer Bounds { vec2 bounds[]; };
#endif
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#ifdef MAP_LAYERS
layout(set = 0, binding = 4) uniform sampler2DArray map;
#else
layout(set = 0, binding = 4) uniform sampler2D map;
#endif
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#ifndef HARD
#include "depth_range.glsl"
#include "blocker_search.glsl"

// Percentage of the disc's points whose texels do not lie before the receiver's plane; bilinear.
float discVisibility(LightCone cone, float spread, vec2 direction)
{
    float lit = 0.0, count = float(min(taps, MAX_SOFT_TAPS));
    for (float i = 0.0; i < count; i += 1.0) { // bound: MAX_SOFT_TAPS
        lit += boxVisibility(cone.tap, placeOf(cone, pointRadius(i, count) * direction, spread), 1.0);
        direction = nextDirection(direction);
    }
    return lit / max(count, 1.0);
}

// Share of the disc above the receiver's own plane, which a map does not know to hide anything.
float shareAbove(PlaneReceiver r)
{
    float distance = constants.map.positional != 0.0 ? length(r.fromLight) : length(constants.map.axisWs.xyz);
    float cosine = clamp(-r.facing / max(distance, 1e-30), 0.0, 1.0);
    float across = radius * sqrt(1.0 - cosine * cosine) / (constants.map.positional != 0.0 ? max(distance, 1e-30) : 1.0);
    float height = min(cosine / max(across, 1e-30), 1.0); // of the centre over the plane, in radii of the disc there
    return 1.0 - (acos(height) - height * sqrt(1.0 - height * height)) / 3.14159265;
}

float softVisibility(LightCone cone, uint layer, out uint reason)
{
    float decided;
    float spread = narrowedCone(cone, uint(constants.map.side), layer, decided);
    reason = decided == 1.0 ? SOFT_LIT : SOFT_DARK;
    if (early != 0u && decided >= 0.0) return decided;
    vec2 direction = firstDirection(gl_FragCoord.xy);
    float count;
    float blocker = meanBlocker(cone, spread, direction, count);
    reason = count > 0.0 ? SOFT_FILTERED : SOFT_EMPTY;
    // Half a texel: the edge of a map is not sharper than that.
    return count > 0.0 ? discVisibility(cone, max(spreadAt(cone, blocker), 0.5), direction) : 1.0;
}
#endif

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
#ifdef HARD
    visibility = r.decided ? r.visibility : nearestVisibility(tap, tap.at);
#else
    uint reason = SOFT_DECIDED;
    visibility = r.visibility;
    if (!r.decided)
        visibility = softVisibility(lightCone(constants.map, tap, mapDepth(constants.map, clip)), uint(layer), reason) *
                     (HAS_NORMALS ? shareAbove(r) : 1.0);
    if (reasons != 0u) visibility = float(reason) / 255.0;
#endif
}
