#version 450
// G-buffer: albedo, and the geometric normal of the side that is seen.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(location = 0) in vec3 positionWs;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normalWs;
layout(push_constant) uniform Object { vec4 colour; } object;

void main()
{
    const vec3 normal = normalize(cross(dFdx(positionWs), dFdy(positionWs)));
    albedo = object.colour;
    normalWs = vec4(dot(normal, frame.eye.xyz - positionWs) < 0.0 ? -normal : normal, 0.0);
}
