#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(location = 0) in vec3 positionOs;
layout(location = 0) flat out uint instanceIndex;
layout(location = 1) out vec3 alphaPosition;

void main()
{
    instanceIndex = gl_InstanceIndex;
    alphaPosition = positionOs;
    vec4 p = vec4(positionOs, 1.0);
    vec3 positionEye = vec3(dot(instances[gl_InstanceIndex].worldFromObject[0], p),
                            dot(instances[gl_InstanceIndex].worldFromObject[1], p),
                            dot(instances[gl_InstanceIndex].worldFromObject[2], p));
    gl_Position = view.clipFromEye * vec4(positionEye, 1.0);
}
