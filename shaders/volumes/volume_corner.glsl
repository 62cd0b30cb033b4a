// What the vertex shaders of shadow volumes have in common: their inputs, and where a corner goes.
#ifndef GNOMON_VOLUMES_VOLUME_CORNER_GLSL
#define GNOMON_VOLUMES_VOLUME_CORNER_GLSL
#include "volume.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Bounds { ReceiverBounds receivers; };

vec4 casterPlane(vec3 reach)
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
    return extrusionPlane(constants.lightEs, reach, lower - margin, upper + margin);
}

// The caster's vertex, or the same moved away from the light, in clip space.
vec4 volumeCorner(VolumePush caster, uint vertex, bool moved)
{
    vec4 os = vec4(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2], 1.0);
    vec3 es = vec3(dot(caster.rows[0], os), dot(caster.rows[1], os), dot(caster.rows[2], os));
    vec4 corner =
        constants.clipFromEye * (moved ? extruded(es, constants.lightEs, casterPlane(caster.reach.xyz)) : vec4(es, 1.0));
    if (!moved) corner.z += caster.reach.w;
    return corner;
}
#endif
