#version 460
// The baseline: a shadow map as short as one can be written. Positions are relative to the eye, like the light matrix.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(location = 0) in vec3 positionOs;
layout(push_constant) uniform Push {
    mat4 lightClipFromEye;
};

void main()
{
    vec4 p = vec4(positionOs, 1.0);
    vec3 positionEye = vec3(dot(instances[gl_InstanceIndex].worldFromObject[0], p),
                            dot(instances[gl_InstanceIndex].worldFromObject[1], p),
                            dot(instances[gl_InstanceIndex].worldFromObject[2], p));
    gl_Position = lightClipFromEye * vec4(positionEye, 1.0);
}
