#version 450
// Deferred lighting: adds up the lights at every pixel, each times its visibility.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#define GNOMON_VISIBILITY_SET 0
#define GNOMON_VISIBILITY_BINDING 4
#include "gnomon/visibility.glsl"
layout(set = 0, binding = 1) uniform sampler2D albedoImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(set = 0, binding = 3) uniform sampler2D depthImage;
layout(location = 0) out vec4 colour;

void main()
{
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const float depth = texelFetch(depthImage, pixel, 0).x; // reversed, no far plane: near / distance ahead
    const vec2 clip = 2.0 * gl_FragCoord.xy / vec2(textureSize(depthImage, 0)) - 1.0;
    const vec2 view = clip / vec2(frame.viewRight.w, frame.viewUp.w);
    const vec3 ray = view.x * frame.viewRight.xyz + view.y * frame.viewUp.xyz - frame.viewBack.xyz;
    const vec3 position = frame.eye.xyz + ray * (frame.eye.w / max(depth, 1e-6));
    vec3 sum = vec3(0.08);
    for (int i = 0; i < LIGHT_COUNT; ++i)
        sum += lightOn(frame.lights[i], position, texelFetch(normalImage, pixel, 0).xyz) * gnomonVisibility(pixel, i);
    colour = vec4(depth == 0.0 ? vec3(0.1, 0.12, 0.16) : texelFetch(albedoImage, pixel, 0).rgb * sum, 1.0);
}
