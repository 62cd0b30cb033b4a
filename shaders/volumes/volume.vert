#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of shadow volumes: index = 2 * vertex + copy; copy 0 is the caster's vertex, copy 1 the same moved away from
// the light.
#include "volume.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
layout(push_constant, std430) uniform Push { VolumePush caster; };

#include "receiver_plane.glsl"

void main()
{
    uint vertex = uint(gl_VertexIndex) >> 1;
    bool moved = (gl_VertexIndex & 1) != 0;
    vec4 os = vec4(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2], 1.0);
    vec3 es = vec3(dot(caster.rows[0], os), dot(caster.rows[1], os), dot(caster.rows[2], os));
    vec4 plane = receiverPlane(caster.reach.xyz);
    gl_Position = constants.clipFromEye * (moved ? extruded(es, constants.lightEs, plane) : vec4(es, 1.0));
    if (!moved) gl_Position.z += caster.reach.w;
}
