#version 460
#extension GL_GOOGLE_include_directive : require
#include "mesh_planes.h"

// Planes of a mesh's faces where the GPU alone knows the positions: updatePlanes() of runtime/scene/topology.cpp.
layout(local_size_x = PLANES_GROUP) in;

layout(push_constant) uniform Push { MeshPlanesPush push; };
layout(std430, set = 0, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, set = 0, binding = 1) readonly buffer Corners { uint corners[]; }; // three a face
layout(std430, set = 0, binding = 2) writeonly buffer Planes { vec4 planes[]; };

vec3 cornerAt(uint place)
{
    uint vertex = corners[place];
    return vec3(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]);
}

void main()
{
    uint face = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * PLANES_GROUP + gl_LocalInvocationID.x;
    if (face >= push.faces) return;
    vec3 a = cornerAt(3 * face);
    precise vec3 normal = cross(cornerAt(3 * face + 1) - a, cornerAt(3 * face + 2) - a);
    precise float distance = -dot(normal, a);
    planes[face] = vec4(normal, distance);
}
