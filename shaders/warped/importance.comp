#version 460
// Where the receivers that a view sees lie in a light's map: for each cell their number, or (RECTILINEAR) for each column
// and each row what texels there are worth: the sum over its receivers of how wide a texel looks, or how near to the eye
// the nearest is. Receivers that no map decides count for nothing.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 1, std430) buffer Importance { uint importance[]; };
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#include "../shared/map_place.glsl"

layout(constant_id = 2) const bool DISCS = false; // the maps are paraboloids

const uint TILE = 4u; // pixels per side that an invocation looks at: neighbours mostly share a cell
#ifdef RECTILINEAR
const int LISTS = 2; // columns, then rows
#else
const int LISTS = 1;
#endif

#ifdef RECTILINEAR
const float SUN_DISTANCE = 4.0; // metres: in place of the distance of a light that has none
const float MOST_RATIO = 16.0;

// A texel looks as wide as it is, in proportion to its distance from the light, over its distance from the eye.
uint weightOf(MapLookup look, float fromLight, float fromEye)
{
    float ratio = (look.positional != 0.0 ? fromLight : SUN_DISTANCE) / fromEye;
    return uint(clamp(ratio * (float(warp.mostWeight) / MOST_RATIO), 1.0, float(warp.mostWeight)));
}
#endif

// The greatest, not a sum. Floats above zero are ordered as their bits are.
bool greatest()
{
#ifdef RECTILINEAR
    return warp.mostWeight == 0u;
#else
    return false;
#endif
}

void put(uint to, uint value)
{
    if (value == 0u || to >= importance.length()) return;
    if (greatest())
        atomicMax(importance[to], value);
    else
        atomicAdd(importance[to], value);
}

MapPlace discPlace(ivec2 pixel, vec3 fromLight)
{
    if (!isDecidedByMap(warp.base.map, pixel, fromLight)) return MapPlace(vec2(-1.0), 1.0, 0u);
    uint map = dot(fromLight, warp.firstWs.xyz) >= 0.0 ? 0u : 1u;
    vec3 local = inParaboloid(warp.discs[map], fromLight);
    float away = max(length(local), 1e-20);
    vec2 at = 0.5 * paraboloidMap(warp.discs[map], paraboloidDisc(local / away)) + 0.5;
    bool inside = min(at.x, at.y) >= 0.0 && max(at.x, at.y) < 1.0;
    return MapPlace(inside ? at : vec2(-1.0), away, map);
}

void main()
{
    uvec2 first = gl_GlobalInvocationID.xy * TILE;
    if (first.x >= warp.pixels.z || first.y >= warp.pixels.w) return;
    ViewConstants view = warp.base.view;
    MapLookup look = warp.base.map;
    vec3 corner = viewRayWs(view, vec2(first + warp.pixels.xy) + 0.5);
    vec4 cornerClip = look.clipFromRay * vec4(corner, 0.0);
    vec4 clipDx = look.clipFromRay * vec4(view.rayDxWs.xyz, 0.0);
    vec4 clipDy = look.clipFromRay * vec4(view.rayDyWs.xyz, 0.0);
    uvec2 last = uvec2(0u), held = uvec2(0u); // what is not added yet, and where to
    for (uint y = 0u; y < TILE; ++y) {
        for (uint x = 0u; x < TILE; ++x) {
            uvec2 inside = first + uvec2(x, y);
            if (inside.x >= warp.pixels.z || inside.y >= warp.pixels.w) continue;
            ivec2 pixel = ivec2(inside + warp.pixels.xy);
            float depth = texelFetch(depthImage, pixel, 0).x;
            if (depth == view.skyDepth) continue;
            float w = linearDepth(view, depth);
            if (!(w > 0.0 && w < 1e30)) continue;
            vec3 ray = corner + float(x) * view.rayDxWs.xyz + float(y) * view.rayDyWs.xyz;
            vec4 rayClip = cornerClip + float(x) * clipDx + float(y) * clipDy;
            MapPlace is = DISCS ? discPlace(pixel, look.eyeFromLight.xyz + w * receiverRayWs(view, ray, depth))
                                : mapPlace(look, view, pixel, depth, w, ray, rayClip);
            if (!(is.at.x >= 0.0)) continue;
#ifdef RECTILINEAR
            uvec2 to = min(uvec2(is.at * float(WARP_BINS)), WARP_BINS - 1u) + uvec2(0u, WARP_BINS);
            to += is.map * 2u * WARP_BINS;
            uint value = greatest() ? floatBitsToUint(1.0 / w) : weightOf(look, is.w, w);
#else
            uint cells = warpCells(look.side);
            uvec2 cell = min(uvec2(is.at * float(cells)), cells - 1u);
            uvec2 to = uvec2((is.map * cells + cell.y) * cells + cell.x, 0u);
            uint value = 1u;
#endif
            for (int i = 0; i < LISTS; ++i) {
                if (to[i] != last[i]) {
                    put(last[i], held[i]);
                    last[i] = to[i];
                    held[i] = 0u;
                }
                held[i] = greatest() ? max(held[i], value) : held[i] + value;
            }
        }
    }
    for (int i = 0; i < LISTS; ++i)
        put(last[i], held[i]);
}
