#version 460
#extension GL_GOOGLE_include_directive : require
// Visibility from counts, in three draws behind stencil tests, of the tiles that resolve_tiles.vert leaves of each. Only
// pixels that range, cone, sky or facing may still decide are shaded.
#include "resolve.h"

layout(constant_id = 0) const uint PART = RESOLVE_DARK;

layout(set = 0, binding = 0, std140) uniform Constants { VolumeResolve resolve; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out float visibility;

void main()
{
    visibility = resolve.shadow;
    if (PART == RESOLVE_DARK) return;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    vec3 toLight = resolve.lightEs.xyz - (resolve.lightEs.w * linearDepth(resolve.view, depth)) * receiverRayWs(resolve.view, rayWs, depth);
    bool reached = depth != resolve.view.skyDepth && reaches(-toLight, resolve.cone, resolve.rangeSquared);
    bool facing = resolve.view.hasNormals == 0u || dot(texelFetch(normalImage, pixel, 0).xyz, toLight) > 0.0;
    float counted = PART == RESOLVE_COUNTED ? resolve.shadow : 1.0;
    visibility = !reached ? 1.0 : facing ? counted : resolve.turnedAway;
}
