#version 460
// Visibility of a light with a radius from moments of its depths, summed over areas. With MAP_LAYERS there are six faces.
#extension GL_GOOGLE_include_directive : require
#include "summed.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    SUMMED_MEMBERS
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#ifdef MAP_LAYERS
layout(set = 0, binding = 4) uniform sampler2DArray map;
#else
layout(set = 0, binding = 4) uniform sampler2D map;
#endif
layout(set = 0, binding = 5) uniform usampler2DArray table;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "../shared/horizon.glsl"

// Sums of all texels before these.
uvec4 summedBefore(uint x, uint y, float layer)
{
    uvec4 sum = texelFetch(table, ivec3(max(x, 1u) - 1u, max(y, 1u) - 1u, layer), 0);
    return x == 0u || y == 0u ? uvec4(0u) : sum;
}

#define SUMMED_BEFORE summedBefore
#include "summed_mean.h"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    float slope = length(tap.depthPerTexel);
    bool positional = constants.map.positional != 0.0;
    vec2 texels = vec2(texelsX, texelsY);
    float z = linearZ(linear, tap.depth);
    float open = max(openZ(linear, tap.depth), z); // receivers may lie beyond the last caster

    // The widest box first; each finds blockers, and with them a narrower one.
    vec2 width = vec2(MAX_SUMMED_BOX);
    float nearest = positional ? 0.25 * open : 0.0;
    float lit = 1.0;
    for (int i = 0; i < 3; ++i) {
        width = min(width, max(texels * softWidth(radius, positional, depthRange, open, nearest), vec2(1.0)));
        vec4 m = mix(boxMean(tap.at, width, uint(constants.map.side), layer), vec4(0.5), momentBias);
        // The deviation of the receiver's plane over the box: without it four moments shadow the plane itself.
        float nearer = linearZ(linear, tap.depth - max(width.x, width.y) * 0.28867513 * slope);
        vec2 before = four != 0u ? hamburgerBefore(m, nearer) : chebyshevBefore(m, deviation * deviation, z);
        lit = before.x > 0.0 ? max(1.0 - before.x, 0.0) : 1.0;
        nearest = before.x > 0.001 ? clamp(before.y / before.x, 0.01 * z, z) : nearest;
    }
    lit = radius > 0.0 ? withoutBleeding(lit, bleeding) : nearestVisibility(tap, tap.at);
    bool beside = !positional && !texelExists(tap, tap.at);
    float above = HAS_NORMALS ? shareAbove(constants.map, r, radius) : 1.0;
    visibility = r.decided ? r.visibility : (beside ? 1.0 : lit) * above;
}
