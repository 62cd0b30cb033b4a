#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(location = 0) in vec3 position;
layout(location = 0) out vec3 positionWs;

void main()
{
    positionWs = position;
    gl_Position = frame.clipFromWorld * vec4(position, 1.0);
}
