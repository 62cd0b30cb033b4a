// What the vertex shaders of shadow volumes have in common: their inputs, and where a corner goes.
#ifndef GNOMON_VOLUMES_VOLUME_CORNER_GLSL
#define GNOMON_VOLUMES_VOLUME_CORNER_GLSL
#include "volume.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
#include "receiver_plane.glsl"

// Sides and caps, which other pipelines may draw, meet at the same corners: else pixels between them would be lost, or
// counted twice. A variable of its own: about gl_Position, which glslang decorates as a member of a block, Mesa warns.
spirv_decorate(11, 0) invariant out vec4 cornerClip; // BuiltIn Position

// The caster's vertex, or the same moved away from the light, in clip space.
vec4 volumeCorner(VolumePush caster, uint vertex, bool moved)
{
    vec4 os = vec4(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2], 1.0);
    vec3 es = vec3(dot(caster.rows[0], os), dot(caster.rows[1], os), dot(caster.rows[2], os));
    vec4 point = moved ? extruded(es, constants.lightEs, receiverPlane(caster.reach.xyz)) : vec4(es, 1.0);
    vec4 corner = constants.clipFromEye * point;
    corner.z += caster.reach.w * point.w;
    return corner;
}
#endif
