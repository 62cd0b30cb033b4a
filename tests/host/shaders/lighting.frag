#version 450
// Adds up the lamps at every pixel, each times its visibility.
#extension GL_GOOGLE_include_directive : require
#include "frame.h"
#define GNOMON_VISIBILITY_SET 1
#define GNOMON_VISIBILITY_BINDING 3
#include "gnomon/visibility.glsl"

layout(set = 1, binding = 0) uniform sampler2D albedoImage;
layout(set = 1, binding = 1) uniform sampler2D normalImage;
layout(set = 1, binding = 2) uniform sampler2D depthImage;
layout(location = 0) out vec4 outColour;

// Depth is reversed and has no far plane: near / distance along the view.
vec3 positionWs(ivec2 pixel, float depth)
{
    const vec2 clip = 2.0 * (vec2(pixel) + 0.5) / vec2(textureSize(depthImage, 0)) - 1.0;
    const float ahead = frame.eye.w / depth;
    const vec2 viewXy = ahead * clip / vec2(frame.viewRight.w, frame.viewUp.w);
    return frame.eye.xyz + viewXy.x * frame.viewRight.xyz + viewXy.y * frame.viewUp.xyz - ahead * frame.viewBack.xyz;
}

void main()
{
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const float depth = texelFetch(depthImage, pixel, 0).x;
    if (depth == 0.0) {
        outColour = vec4(0.02, 0.02, 0.04, 1.0);
        return;
    }
    const vec3 position = positionWs(pixel, depth), normal = texelFetch(normalImage, pixel, 0).xyz;
    vec3 sum = vec3(0.02);
    for (int i = 0; i < LAMP_COUNT; ++i) {
        const vec3 toLamp = frame.lamps[i].positionAndRange.xyz - position;
        const float away = length(toLamp), range = frame.lamps[i].positionAndRange.w;
        const float facing = dot(normal, toLamp) / away;
        if (facing <= 0.0 || away >= range) continue;
        const float edge = 1.0 - pow(away / range, 4.0); // fades out at the range
        sum += frame.lamps[i].colour.rgb * facing * edge * edge * 4.0 / (1.0 + away * away) *
               gnomonVisibility(pixel, i);
    }
    outColour = vec4(pow(texelFetch(albedoImage, pixel, 0).rgb * sum, vec3(1.0 / 2.2)), 1.0);
}
