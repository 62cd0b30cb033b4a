#version 460
// Pixels at an edge of the hard shadow: how wide the penumbra is there, metres, and where the edge is; 0 elsewhere. With
// MAP_LAYERS the map is the six faces around a point light.
#extension GL_GOOGLE_include_directive : require
#include "distance.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uvec4 rect;
    float width;
    float disc;
    uint show;
};
#include "../shared/map_inputs.glsl"
layout(set = 0, binding = 5) uniform sampler2D states;
layout(location = 0) out vec2 seed;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "distance_seen.glsl"
#include "revectorize.h"

// Whether the shadow ends between these pixels, on a surface of both.
bool endsBefore(Surface here, bool lit, ivec2 beside)
{
    ivec2 low = ivec2(rect.xy), high = low + ivec2(rect.zw);
    if (any(lessThan(beside, low)) || any(greaterThanEqual(beside, high))) return false;
    float state = stateAt(beside);
    if (!isAsked(state) || isLit(state) == lit) return false;
    Surface there = seenAt(beside);
    return goesAlong(here, there, there.atWs - here.atWs, 0.0);
}

// How wide the light's disc is cast over what hides it, at right angles to the light: from the mean depth of the texels
// around that hide the receiver's plane (Macedo 2018, Eqs 5.1 and 5.2, in metres). 0 with none.
float castWidth(Tap tap, float own)
{
    vec2 centre = floor(tap.at) + 0.5;
    float sum = 0.0, count = 0.0;
    for (int y = 0; y < BLOCKER_SIDE; ++y) {
        for (int x = 0; x < BLOCKER_SIDE; ++x) {
            vec2 texel = centre + vec2(x - BLOCKER_SIDE / 2, y - BLOCKER_SIDE / 2);
            float depth = mapTexel(tap, texel);
            bool hides = texelExists(tap, texel) && min(tapDepth(tap, texel), 1.0) > depth;
            sum += hides ? depth : 0.0;
            count += hides ? 1.0 : 0.0;
        }
    }
    float blocker = sum / max(count, 1.0);
    MapLookup look = constants.map;
    // Distances from the light are as 1 / (depthConstant - depth).
    float gap = look.positional != 0.0 ? (look.depthConstant - blocker) / max(look.depthConstant - own, 1e-20) - 1.0
                                       : (own - blocker) * length(look.axisWs.xyz);
    return count > 0.0 ? 2.0 * disc * max(gap, 0.0) : 0.0;
}

// Where a pixel's receiver is in a layer of the map, texels.
vec2 placeOf(ivec2 pixel, float layer)
{
    PlaneReceiver r;
    r.depth = texelFetch(depthImage, pixel, 0).x;
    r.w = linearDepth(constants.view, r.depth);
    vec3 viewRay = viewRayWs(constants.view, vec2(pixel) + 0.5);
#ifdef MAP_LAYERS
    vec3 fromLight = constants.map.eyeFromLight.xyz + r.w * receiverRayWs(constants.view, viewRay, r.depth);
    vec4 clip = cubeClip(constants.map, fromLight, uint(layer));
#else
    vec4 clip = receiverClip(constants.map, r, constants.map.clipFromRay * vec4(viewRay, 0.0));
#endif
    return clip.xy / clip.w;
}

// Where the shadow's edge is on the way from the tap to a place with the other state: 0 at the tap, 1 there.
float endOn(Tap tap, bool lit, vec2 there)
{
    float near = 0.0, far = 1.0;
    for (int i = 0; i < EDGE_STEPS; ++i) {
        float middle = 0.5 * (near + far);
        vec2 at = mix(tap.at, there, middle);
        bool same = (revectorizedVisibility(tap, at, REVECTORIZE_NONCONSERVATIVE, LONGEST_STAIR) > 0.5) == lit;
        near = same ? middle : near;
        far = same ? far : middle;
    }
    return 0.5 * (near + far);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float state = stateAt(pixel);
    bool lit = isLit(state);
    seed = vec2(0.0);
    if (!isAsked(state)) return;
    Surface here = seenAt(pixel);
    int ends = 0;
    for (int side = 0; side < 4; ++side)
        ends |= endsBefore(here, lit, pixel + stepTo(side)) ? 1 << side : 0;
    if (ends == 0) return;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    float nearest = 1.0;
    for (int side = 0; side < 4; ++side) {
        if ((ends >> side & 1) == 0) continue;
        float end = endOn(tap, lit, placeOf(pixel + stepTo(side), layer));
        if (end >= nearest) continue;
        nearest = end;
        seed.y = float(2 * side) + end;
    }
    float wide = width > 0.0 ? width : castWidth(tap, mapDepth(constants.map, clip));
    seed.x = clamp(wide, max(here.pixelWs, 1e-4), 6e4); // no sharper than a pixel; within half floats
}
