#version 460
#extension GL_GOOGLE_include_directive : require
// Visibility from counts, in two draws: dark behind a stencil test where a pixel lies in some volume; then, everywhere,
// what needs no casters. Blended as colour + what is there * alpha: the second draw keeps what it does not decide.
#include "volume.h"

layout(constant_id = 0) const bool COUNTED = false; // the first draw

layout(set = 0, binding = 0, std140) uniform Constants { VolumeResolve resolve; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out vec4 visibility;

void main()
{
    visibility = vec4(resolve.shadow, 0.0, 0.0, 0.0);
    if (COUNTED) return;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    vec3 toLight = resolve.lightEs.xyz - (resolve.lightEs.w * linearDepth(resolve.view, depth)) * rayWs;
    bool reached = depth != resolve.view.skyDepth && reaches(-toLight, resolve.cone, resolve.rangeSquared);
    bool facing = resolve.view.hasNormals == 0u || dot(texelFetch(normalImage, pixel, 0).xyz, toLight) > 0.0;
    visibility.r = !reached ? 1.0 : facing ? 0.0 : resolve.turnedAway;
    visibility.a = reached && facing ? 1.0 : 0.0;
}
