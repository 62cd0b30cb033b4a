#version 460
#extension GL_GOOGLE_include_directive : require
#include "runtime/mesh_read.h"

// Triangles of a mesh out of the host's index buffer, as three 32-bit indices each. One invocation a triangle. One with
// a corner past the vertices becomes a point, which casts nothing.
layout(local_size_x = MESH_GROUP) in;

layout(push_constant) uniform Push { MeshIndicesRead read; };
layout(std430, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Target { uint target[]; };
layout(std430, set = 0, binding = 2) buffer Findings {
    uint firstWrongVertex;
    uint firstWrongIndex; // the least; all ones: none
};

const uint NO_VERTEX = 0xffffffffu;

uint givenIndex(uint number)
{
    if (read.indexBytes == 0) return number;
    uint address = read.firstByte + number * read.indexBytes;
    uint word = source[address >> 2];
    return read.indexBytes == 4 ? word : (word >> 8 * (address & 2u)) & 0xffffu;
}

// Below vertexCount, or NO_VERTEX.
uint vertexAt(uint number)
{
    uint index = givenIndex(number), vertex = index + read.vertexOffset;
    bool down = (read.vertexOffset & 0x80000000u) != 0u;
    bool wrapped = down ? vertex > index : vertex < index;
    if (!wrapped && vertex < read.vertexCount) return vertex;
    atomicMin(firstWrongIndex, number);
    return NO_VERTEX;
}

void main()
{
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint triangle = group * MESH_GROUP + gl_LocalInvocationID.x;
    if (triangle >= read.triangleCount) return;
    uvec3 corners = uvec3(vertexAt(3 * triangle), vertexAt(3 * triangle + 1), vertexAt(3 * triangle + 2));
    if (read.turned != 0) corners = corners.xzy;
    if (any(equal(corners, uvec3(NO_VERTEX)))) corners = uvec3(0);
    target[3 * triangle] = corners.x;
    target[3 * triangle + 1] = corners.y;
    target[3 * triangle + 2] = corners.z;
}
