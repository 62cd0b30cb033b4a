#version 460
// Counts the points of a light that a pixel does not see, behind stencil tests: this one where volumes were counted,
// and elsewhere (TURNED) on surfaces that face away from it.
#extension GL_GOOGLE_include_directive : require
#include "multi_volume.h"

layout(constant_id = 0) const bool TURNED = false;

layout(set = 0, binding = 0, std140) uniform Constants { MultiVolume multi; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out vec4 hidden; // alpha 1: added to what is there

void main()
{
    hidden = vec4(1.0, 0.0, 0.0, 1.0);
    if (!TURNED) return;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 toPoint = wayTo(multi.volumes, multi.pointEs.xyz, rayWs, texelFetch(depthImage, pixel, 0).x);
    hidden.x = dot(texelFetch(normalImage, pixel, 0).xyz, toPoint) > 0.0 ? 0.0 : 1.0;
}
