// Where a light's volumes end: a plane behind everything that view rays can cross. The includer declares `VolumeConstants
// constants`; bounds of the visible receivers are at binding 2.
#ifndef GNOMON_VOLUMES_RECEIVER_PLANE_GLSL
#define GNOMON_VOLUMES_RECEIVER_PLANE_GLSL
#include "volume.h"

layout(set = 0, binding = 2, std430) readonly buffer Bounds { ReceiverBounds receivers; };

// reach: of extrusionPlane().
vec4 receiverPlane(vec3 reach)
{
    vec3 lower = vec3(fromOrderedKey(receivers.lower[0]), fromOrderedKey(receivers.lower[1]),
                      fromOrderedKey(receivers.lower[2]));
    vec3 upper = vec3(fromOrderedKey(receivers.upper[0]), fromOrderedKey(receivers.upper[1]),
                      fromOrderedKey(receivers.upper[2]));
    // What view rays can cross: from the near rectangle to receivers that the light reaches.
    lower = min(constants.nearLowerEs.xyz, max(lower, constants.rangeLowerEs.xyz));
    upper = max(constants.nearUpperEs.xyz, min(upper, constants.rangeUpperEs.xyz));
    // Covers the rounding of far edges, some hundred times: floats know their place in the box to 2^-23 of its size.
    vec3 margin = vec3(1e-3 + (1.0 / 4096.0) * max(upper.x - lower.x, max(upper.y - lower.y, upper.z - lower.z)));
    vec4 plane = extrusionPlane(constants.lightEs, reach, lower - margin, upper + margin);
    // Not an early return: with one Mesa 22.3 compiles a shader that samples as well again for every draw.
    bool ends = constants.nearLowerEs.w != 0.0 && plane.xyz != vec3(0.0);
    return ends ? plane : vec4(vec3(0.0), constants.nearUpperEs.w);
}
#endif
