#version 460
// Casters into a map of depth and triangle numbers: as shared/depth_map.vert, and the number of the caster's first triangle.
#extension GL_GOOGLE_include_directive : require
#define GNOMON_NUMBERED_DRAWS // gl_PrimitiveID starts from 0 with every draw
#include "../shared/caster_clip.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Firsts {
    uint firsts[]; // by index of the caster
};
layout(location = 0) flat out uint first;

void main()
{
    gl_Position = casterClip();
    first = firsts[gl_InstanceIndex] + firstFace;
}
