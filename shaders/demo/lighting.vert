#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(location = 0) out vec3 ray; // view ray of linear depth 1

void main()
{
    vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    vec2 pixel = corner * view.extent.xy;
    ray = view.rayCorner.xyz + pixel.x * view.rayDx.xyz + pixel.y * view.rayDy.xyz;
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
