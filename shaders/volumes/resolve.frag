#version 460
#extension GL_GOOGLE_include_directive : require
// Visibility behind a stencil test: drawn once where the count is 0, once where it is not.
#include "volume.h"

layout(constant_id = 0) const bool COUNTED = false; // this draw's pixels lie in some volume

layout(set = 0, binding = 0, std140) uniform Constants { VolumeResolve resolve; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(location = 0) out float visibility;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    vec3 receiverEs = linearDepth(resolve.view, depth) * viewRayWs(resolve.view, gl_FragCoord.xy);
    vec3 toLight = resolve.lightEs.xyz - resolve.lightEs.w * receiverEs;
    bool reached = depth != resolve.view.skyDepth && reaches(resolve, toLight);
    bool facing = resolve.view.hasNormals == 0u || dot(texelFetch(normalImage, pixel, 0).xyz, toLight) > 0.0;
    visibility = !reached ? 1.0 : !COUNTED && facing ? 1.0 : 0.0;
}
