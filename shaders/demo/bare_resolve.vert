#version 460
// The view ray in the light's clip space, interpolated: a look-up then costs one multiply-add (lightClip = a w + b).
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(location = 0) noperspective out vec4 lightClipRay;
layout(push_constant) uniform Push {
    mat4 lightClipFromEye;
};

void main()
{
    vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    vec2 pixel = corner * view.extent.xy;
    vec3 ray = view.rayCorner.xyz + pixel.x * view.rayDx.xyz + pixel.y * view.rayDy.xyz;
    lightClipRay = lightClipFromEye * vec4(ray, 0.0);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
