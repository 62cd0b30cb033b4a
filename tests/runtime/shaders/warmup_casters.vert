#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/casters.glsl"
layout(push_constant) uniform Push { mat4 clipFromWorld; };
void main()
{
    gl_Position = clipFromWorld * vec4(casterWorldPosition(), 1.0);
}
