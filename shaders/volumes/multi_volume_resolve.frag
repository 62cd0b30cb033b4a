#version 460
// Visibility from the number of points that are hidden.
#extension GL_GOOGLE_include_directive : require
#include "multi_volume.h"

layout(set = 0, binding = 0, std140) uniform Constants { MultiVolume multi; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(set = 0, binding = 3) uniform sampler2D hiddenImage;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out float visibility;

void main()
{
    VolumeResolve resolve = multi.volumes;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    vec3 toLight = wayTo(resolve, resolve.lightEs.xyz, rayWs, depth);
    bool reached = depth != resolve.view.skyDepth && reaches(-toLight, resolve.cone, resolve.rangeSquared);
    bool facing = resolve.view.hasNormals == 0u || dot(texelFetch(normalImage, pixel, 0).xyz, toLight) > 0.0;
    float seen = 1.0 - multi.pointEs.w * texelFetch(hiddenImage, pixel, 0).x;
    visibility = !reached ? 1.0 : facing ? clamp(seen, 0.0, 1.0) : 0.0;
}
