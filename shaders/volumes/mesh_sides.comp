#version 460
#extension GL_GOOGLE_include_directive : require
#include "mesh_volume.h"

// Sides of a volume: findSilhouette() and writeSides() of algorithms/volumes/silhouette.cpp, an edge each.
layout(local_size_x = MESH_VOLUME_GROUP) in;

layout(push_constant, std430) uniform Push { MeshVolumePush push; };
// Of every edge two vertices, its first use (a place) and how many there are; then uses, 2 * face + 1 where the face runs
// from the first vertex to the second, else 2 * face.
layout(set = 0, binding = 0, std430) readonly buffer Edges { uint words[]; };
layout(set = 0, binding = 1, std430) readonly buffer Planes { vec4 planes[]; };
layout(set = 0, binding = 2, std430) buffer List { uint list[]; };

#include "volume_sides.glsl"

void main()
{
    uint edge = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * MESH_VOLUME_GROUP + gl_LocalInvocationID.x;
    if (edge == 0u) beginCommand(push.command, push.firstIndex);
    if (edge >= push.count) return;
    uint at = 4u * (push.first + edge), firstUse = words[at + 2u];
    int sum = 0;
    uint uses = min(words[at + 3u], uint(words.length()));
    for (uint i = 0u; i < uses; ++i) { // bound: words
        uint use = words[firstUse + i];
        sum += edgeWay(faceWay(planes[use >> 1], push.light), (use & 1u) != 0u);
    }
    appendSides(push.command, push.firstIndex, words[at], words[at + 1u], sum, push.halves);
}
