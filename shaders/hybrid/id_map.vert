#version 460
// Casters into a map of depth and triangle numbers: as maps/depth_map.vert, and the number of the caster's first triangle.
#extension GL_GOOGLE_include_directive : require
#include "../shared/casters.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Firsts {
    uint firsts[]; // by index of the caster
};
layout(push_constant) uniform Push {
    mat4 clipFromZero;
    vec4 zeroWs;
};
layout(location = 0) flat out uint first;

void main()
{
    gl_Position = clipFromZero * vec4(casterWorldPosition() - zeroWs.xyz, 1.0);
    first = firsts[gl_InstanceIndex];
}
