#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(set = 1, binding = 0) uniform sampler2D depthImage;
layout(set = 1, binding = 1) uniform sampler2D shadowMap;
layout(push_constant) uniform Push {
    mat4 lightClipFromEye;
};
layout(location = 0) noperspective in vec4 lightClipRay;
layout(location = 0) out float visibility;

void main()
{
    float depth = texelFetch(depthImage, ivec2(gl_FragCoord.xy), 0).x;
    vec4 lightClip = lightClipRay * (view.depthScale / (depth + view.depthAdd)) + lightClipFromEye[3];
    vec3 ndc = lightClip.xyz / lightClip.w;
    float nearest = textureLod(shadowMap, ndc.xy * 0.5 + 0.5, 0.0).x;
    visibility = ndc.z <= nearest ? 1.0 : 0.0;
}
