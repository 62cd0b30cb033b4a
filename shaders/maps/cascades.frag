#version 460
// Visibility of a directional light from the finest of its maps that a receiver lies in.
#extension GL_GOOGLE_include_directive : require
#define MAP_LAYERS 1
#include "cascades.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    vec4 parts[MAX_CASCADES];
    uint count;
    float lastLayer;
    float border;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2DArray map; // border: depth 1
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/planar_tap.glsl"
#include "../shared/filter.glsl"

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    vec4 clip = receiverClip(look, r, rayClip);
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    PlanarDepth plane = planeOf(look, r, clip, normalPerTexel);
    // The last map is all casters': beside it nothing is in shadow.
    uint last = clamp(count, 1u, MAX_CASCADES) - 1u;
    vec4 part = parts[last];
    float layer = lastLayer;
    for (uint i = last; i > 0u; --i) { // bound: MAX_CASCADES
        vec4 finer = parts[i - 1u];
        vec2 at = clip.xy * finer.xy + finer.zw;
        bool inside = min(at.x, at.y) >= border && max(at.x, at.y) <= look.side - border;
        part = inside ? finer : part;
        layer = inside ? float(i - 1u) : layer;
    }
    plane.perTexel /= part.xy;
    Tap tap = tapAt(look, plane, clip.xy * part.xy + part.zw, layer);
    float lit = FILTERED ? boxVisibility(tap, tap.at, look.filterSide) : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
