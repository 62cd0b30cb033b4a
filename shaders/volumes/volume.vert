#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of shadow volumes: index = 2 * vertex + copy; copy 0 is the caster's vertex, copy 1 the same moved away from
// the light.
#include "volume.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Bounds { ReceiverBounds receivers; };
layout(push_constant, std430) uniform Push { VolumePush caster; };

vec4 casterPlane()
{
    if (constants.nearLowerEs.w == 0.0) return vec4(0.0);
    vec3 lower = vec3(fromOrderedKey(receivers.lower[0]), fromOrderedKey(receivers.lower[1]),
                      fromOrderedKey(receivers.lower[2]));
    vec3 upper = vec3(fromOrderedKey(receivers.upper[0]), fromOrderedKey(receivers.upper[1]),
                      fromOrderedKey(receivers.upper[2]));
    // What view rays can cross: from the near rectangle to receivers that the light reaches.
    lower = min(constants.nearLowerEs.xyz, max(lower, constants.rangeLowerEs.xyz));
    upper = max(constants.nearUpperEs.xyz, min(upper, constants.rangeUpperEs.xyz));
    // Covers the rounding of far edges, some hundred times: floats know their place in the box to 2^-23 of its size.
    vec3 margin = vec3(1e-3 + (1.0 / 4096.0) * max(upper.x - lower.x, max(upper.y - lower.y, upper.z - lower.z)));
    return extrusionPlane(constants.lightEs, caster.reach.xyz, lower - margin, upper + margin);
}

void main()
{
    uint vertex = uint(gl_VertexIndex) >> 1;
    bool moved = (gl_VertexIndex & 1) != 0;
    vec4 os = vec4(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2], 1.0);
    vec3 es = vec3(dot(caster.rows[0], os), dot(caster.rows[1], os), dot(caster.rows[2], os));
    gl_Position = constants.clipFromEye * (moved ? extruded(es, constants.lightEs, casterPlane()) : vec4(es, 1.0));
    if (!moved) gl_Position.z += caster.reach.w;
}
