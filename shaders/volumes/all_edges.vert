#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_spirv_intrinsics : require
// Corners of shadow volumes from all edges (or faces) of a mesh. What does not bound the volume shrinks to a point within
// the view, which every device drops before it looks at pixels and none has to clip.
#include "all_edges.h"
#include "volume_corner.glsl"

layout(constant_id = 0) const bool CAPS = false;

layout(set = 0, binding = 3, std430) readonly buffer List { uvec4 slots[]; };
layout(set = 0, binding = 4, std430) readonly buffer Planes { vec4 planes[]; };
layout(push_constant, std430) uniform Push { AllEdgesPush push; };

uint wayOf(uint plane)
{
    vec4 at = push.firstPlane != 0u ? planes[plane - push.firstPlane] : uintBitsToFloat(slots[plane]);
    return faceWay(at, push.light);
}

uint sideVertex(uint index)
{
    uvec4 edge = slots[index >> 2];
    return sideCorner(edge, wayOf(edge.z >> 1), wayOf(edge.w >> 1), uint(gl_InstanceIndex), index & 3u);
}

uint capVertex(uint index)
{
    uvec4 face = slots[index >> 3];
    return capCorner(face, wayOf(face.w), push.capsWay, (index >> 2) & 1u, index & 3u);
}

void main()
{
    uint corner = CAPS ? capVertex(uint(gl_VertexIndex)) : sideVertex(uint(gl_VertexIndex));
    uint drawn = corner == NO_CORNER ? 0u : corner;
    vec4 position = volumeCorner(push.caster, drawn >> 1, (drawn & 1u) != 0u);
    cornerClip = corner == NO_CORNER ? vec4(0.0, 0.0, 0.0, 1.0) : position;
}
