#version 450
// G-buffer: flat-shaded triangles in world space.
#extension GL_GOOGLE_include_directive : require
#include "frame.h"

layout(location = 0) in vec3 positionWs;
layout(location = 1) in vec3 normalWs;
layout(location = 2) in vec3 colour;
layout(location = 0) out vec3 surfaceWs;
layout(location = 1) flat out vec3 surfaceNormalWs;
layout(location = 2) flat out vec3 albedo;

void main()
{
    surfaceWs = positionWs;
    surfaceNormalWs = normalWs;
    albedo = colour;
    gl_Position = frame.clipFromWorld * vec4(positionWs, 1.0);
}
