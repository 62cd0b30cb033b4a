#version 460
// Share of a light's source that is seen: the mean over points of it that have a layer of the map each. PART adds up
// what the last pass, which writes visibility, goes on from. BITS: which of the points are seen, a bit for each. RAMPS:
// four bits for each, of edges as ramps about lines.
#extension GL_GOOGLE_include_directive : require
#define MAP_LAYERS
#include "area_light.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    MapLookup points[MAX_AREA_MAPS];
    uint count;
    float share;
    uint continues;
    uint needed;
    vec4 gapX;
    vec4 gapY;
};
#include "../shared/map_inputs.glsl"
#if defined(BITS)
layout(location = 0) out uint bits;
#elif defined(RAMPS)
layout(location = 0) out uvec4 codes;
#elif defined(PART)
layout(location = 0) out vec4 sum; // alpha 1: added to what is there
#else
layout(set = 0, binding = 5) uniform sampler2D sums;
layout(location = 0) out float visibility;
#endif

#include "../shared/planar_tap.glsl"
#include "../shared/filter.glsl"
#ifdef RAMPS
#include "gap_kernel.glsl"
#include "ramp_codes.glsl"
#endif

// 1 or 0; of a point among others, bilinear between texels. What is below the receiver's plane does not shine on it.
float pointVisibility(PlaneReceiver r, uint i)
{
    r.fromLight = points[i].eyeFromLight.xyz + r.w * r.ray;
    r.facing = dot(r.normalWs, r.fromLight * points[i].positional + points[i].axisWs.xyz);
    vec4 clip = points[i].clipOfEye + r.w * (points[i].clipFromRay * vec4(r.ray, 0.0));
    if (!(r.facing < 0.0)) return 0.0;
    if (clip.w <= 0.0) return 1.0; // behind the point, where no caster is drawn
    vec2 normalPerTexel = vec2(dot(r.normalWs, points[i].texelDx.xyz), dot(r.normalWs, points[i].texelDy.xyz));
    Tap tap = planarTap(points[i], r, clip, normalPerTexel, float(i));
#ifdef RAMPS
    return gapVisibility(tap, points[i], gapX.xyz, gapY.xyz, uint(constants.map.filterSide));
#else
    return share < 1.0 ? boxVisibility(tap, tap.at, 1.0) : nearestVisibility(tap, tap.at);
#endif
}

#if defined(BITS)
void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    bits = r.decided && r.visibility > 0.0 ? ~0u : 0u;
    if (r.decided) return;
    for (uint i = 0u; i < min(count, MAX_AREA_MAPS); ++i) // bound: MAX_AREA_MAPS
        if ((needed >> i & 1u) != 0u && pointVisibility(r, i) > 0.0) bits |= 1u << i;
}
#elif defined(RAMPS)
void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    codes = uvec4(r.decided && r.visibility > 0.0 ? ~0u : 0u);
    if (r.decided) return;
    for (uint i = 0u; i < min(count, MAX_AREA_MAPS); ++i) // bound: MAX_AREA_MAPS
        if ((needed >> i & 1u) != 0u) codes[i >> 3] |= codeOf(pointVisibility(r, i)) << 4u * (i & 7u);
}
#else
void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float seen = 0.0;
    if (!r.decided)
        for (uint i = 0u; i < min(count, MAX_AREA_MAPS); ++i) // bound: MAX_AREA_MAPS
            seen += pointVisibility(r, i);
#ifdef PART
    sum = vec4(seen, 0.0, 0.0, 1.0);
#else
    float before = continues != 0u ? texelFetch(sums, ivec2(gl_FragCoord.xy), 0).x : 0.0;
    visibility = r.decided ? r.visibility : clamp((before + seen) * share, 0.0, 1.0);
#endif
}
#endif
