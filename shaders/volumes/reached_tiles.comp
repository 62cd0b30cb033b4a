#version 460
#extension GL_GOOGLE_include_directive : require
// Which tiles of the view a light can matter to: those that its range and cone touch, unless one umbra holds all that
// is seen there. Of such a tile only that one volume needs to be drawn.
#include "cull.h"

layout(local_size_x = 64) in; // CULL_GROUP

layout(set = 0, binding = 0, std140) uniform Constants { ReachConstants light; };
layout(set = 0, binding = 1, std430) readonly buffer Tiles { ReceiverTile tiles[]; };
layout(set = 0, binding = 2, std430) readonly buffer Regions { UmbraRegion umbrae[UMBRAE]; };
layout(set = 0, binding = 3, std430) buffer Reached {
    uint count;
    uint needed; // bit i: umbra i holds a tile
    uint padding[2];
    ReachedBox reached[];
};

bool inReach(vec3 center, vec3 halfExtent)
{
    if (light.lightWs.w == 0.0) return true;
    vec3 fromLight = center - light.lightWs.xyz;
    vec3 outside = max(abs(fromLight) - halfExtent, vec3(0.0));
    if (dot(outside, outside) > light.range * light.range) return false;
    if (light.axis.w < 0.0) return true;
    // The sphere around the box against the cone, whose half angle is below a right one.
    float along = dot(fromLight, light.axis.xyz);
    float across = sqrt(max(dot(fromLight, fromLight) - along * along, 0.0));
    return across * light.axis.w - along * light.sine <= length(halfExtent);
}

uint umbraAround(vec3 center, vec3 halfExtent)
{
    for (uint i = 0; i < UMBRAE; ++i) {
        if ((light.umbraMask >> i & 1u) == 0u) continue;
        bool within = true;
        for (uint p = 0; p < UMBRA_PLANES; ++p)
            within = within && boxWithin(umbrae[i].planes[p], center, halfExtent, 0.0);
        if (within) return i;
    }
    return NO_UMBRA;
}

void main()
{
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= light.tileCount) return;
    vec3 lower = tiles[tile].lower.xyz, upper = tiles[tile].upper.xyz;
    if (lower.x > upper.x) return;
    vec3 margin = vec3(receiverMargin(lower, upper));
    vec3 halfExtent = 0.5 * (upper - lower) + margin;
    vec3 center = 0.5 * (lower + upper) + light.eyeWs.xyz;
    if (!inReach(center, halfExtent)) return;
    uint umbra = umbraAround(center, halfExtent);
    if (umbra != NO_UMBRA) {
        if ((needed >> umbra & 1u) == 0u) atomicOr(needed, 1u << umbra);
        return;
    }
    reached[atomicAdd(count, 1u)] = ReachedBox(vec4(center, 0.0), vec4(halfExtent, 0.0));
}
