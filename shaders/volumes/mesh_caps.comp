#version 460
#extension GL_GOOGLE_include_directive : require
#include "all_edges.h"
#include "mesh_volume.h"

// Near and far caps of the volume of a caster whose positions the GPU alone knows: writeCaps() of
// algorithms/volumes/silhouette.cpp, a face each.
layout(local_size_x = MESH_VOLUME_GROUP) in;

layout(push_constant, std430) uniform Push { MeshVolumePush push; };
layout(set = 0, binding = 0, std430) readonly buffer Corners { uint corners[]; }; // three a face
layout(set = 0, binding = 1, std430) readonly buffer Planes { vec4 planes[]; };
layout(set = 0, binding = 2, std430) buffer List { uint list[]; };

#include "volume_sides.glsl"

void main()
{
    uint face = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * MESH_VOLUME_GROUP + gl_LocalInvocationID.x;
    if (face == 0u) beginCommand(push.command, push.firstIndex);
    if (face >= push.count) return;
    uint way = faceWay(planes[face], push.light);
    uvec4 vertices = uvec4(corners[3u * face], corners[3u * face + 1u], corners[3u * face + 2u], 0u);
    if (capCorner(vertices, way, push.capsWay, 0u, 0u) == NO_CORNER) return;
    uint next = push.firstIndex + atomicAdd(list[push.command], 6u);
    for (uint copy = 0u; copy < 2u; ++copy) // the far cap goes round the other way
        for (uint i = 0u; i < 3u; ++i)
            list[next + 3u * copy + i] = capCorner(vertices, way, push.capsWay, copy, (i << copy) % 3u);
}
