#version 460
#extension GL_GOOGLE_include_directive : require
#include "runtime/mesh_read.h"

// Positions of a mesh out of the host's buffer, as three floats each. One invocation a vertex.
layout(local_size_x = MESH_GROUP) in;

layout(push_constant) uniform Push { MeshPositionsRead read; };
layout(std430, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Target { float target[]; };
layout(std430, set = 0, binding = 2) buffer Findings {
    uint firstWrongVertex; // the least; all ones: none
    uint firstWrongIndex;
};
layout(std430, set = 0, binding = 3) buffer Watched {
    uint firstApart; // the least; all ones: none
    uint welded[];   // for every vertex the one that it should be at
};

vec3 positionAt(uint word)
{
    if (read.format == MESH_FLOATS)
        return uintBitsToFloat(uvec3(source[word], source[word + 1], source[word + 2]));
    uint xy = source[word], z = source[word + 1];
    return read.format == MESH_HALVES ? vec3(unpackHalf2x16(xy), unpackHalf2x16(z).x)
                                      : vec3(unpackSnorm2x16(xy), unpackSnorm2x16(z).x);
}

// Of its bits: comparisons with NaN may be taken for granted by a compiler.
bool usable(float value)
{
    return (floatBitsToUint(value) & 0x7fffffffu) <= floatBitsToUint(1e18);
}

bool usable(vec3 position)
{
    return usable(position.x) && usable(position.y) && usable(position.z);
}

vec3 positionOf(uint vertex)
{
    precise vec3 position = positionAt(read.firstWord + vertex * read.strideWords) * read.scale.xyz + read.bias.xyz;
    return position;
}

void main()
{
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint vertex = group * MESH_GROUP + gl_LocalInvocationID.x;
    if (vertex >= read.count) return;
    vec3 position = positionOf(vertex);
    if (!usable(position)) {
        atomicMin(firstWrongVertex, vertex);
        position = vec3(0.0);
    }
    if (read.watches != 0) {
        vec3 other = positionOf(min(welded[vertex], read.count - 1));
        if (position != (usable(other) ? other : vec3(0.0))) atomicMin(firstApart, vertex);
    }
    target[3 * vertex] = position.x;
    target[3 * vertex + 1] = position.y;
    target[3 * vertex + 2] = position.z;
}
