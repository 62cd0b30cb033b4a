#version 460
#extension GL_GOOGLE_include_directive : require
// Draws or drops kept volumes: copies the indirect commands of their sides and caps, with no instance where the volume
// touches nothing that matters.
#include "cull.h"

layout(local_size_x = 64) in; // CULL_GROUP

struct Command {
    uint indexCount;
    uint instanceCount;
    uint firstIndex;
    int vertexOffset;
    uint firstInstance;
};

layout(set = 0, binding = 0, std140) uniform Constants { CullConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Kept {
    KeptUmbra umbrae[UMBRAE];
    KeptVolume volumes[];
};
layout(set = 0, binding = 2, std430) readonly buffer Reached {
    uint count;
    uint needed;
    uint padding[2];
    ReachedBox reached[];
};
layout(set = 0, binding = 3, std430) readonly buffer Sides { Command sides[]; };
layout(set = 0, binding = 4, std430) readonly buffer Caps { Command caps[]; };
layout(set = 0, binding = 5, std430) writeonly buffer KeptSides { Command keptSides[]; };
layout(set = 0, binding = 6, std430) writeonly buffer KeptCaps { Command keptCaps[]; };

bool matters(uint volume)
{
    uint umbra = volumes[volume].umbra;
    if (umbra != NO_UMBRA && (needed >> umbra & 1u) != 0u) return true;
    vec4 planes[SHADOW_PLANES];
    for (uint p = 0; p < SHADOW_PLANES; ++p)
        planes[p] = volumes[volume].shadow[p];
    for (uint i = 0; i < count; ++i) {
        vec3 center = reached[i].center.xyz, halfExtent = reached[i].halfExtent.xyz;
        bool beyond = false;
        for (uint p = 0; p < SHADOW_PLANES; ++p)
            beyond = beyond || boxBeyond(planes[p], center, halfExtent, 0.0);
        if (!beyond) return true;
    }
    return false;
}

void main()
{
    uint candidate = gl_GlobalInvocationID.x;
    if (candidate >= constants.counts.x) return;
    uint volume = constants.candidates[candidate / 4u][candidate % 4u];
    uint instances = matters(volume) ? 1u : 0u;
    uint firstSide = volumes[volume].firstSide, sideCount = volumes[volume].sideCount;
    for (uint i = firstSide; i < firstSide + sideCount; ++i)
        keptSides[i] = Command(sides[i].indexCount, instances, sides[i].firstIndex, 0, 0u);
    if (constants.counts.y == 0u) return;
    uint firstCap = volumes[volume].firstCap, capCount = volumes[volume].capCount;
    for (uint i = firstCap; i < firstCap + capCount; ++i)
        keptCaps[i] = Command(caps[i].indexCount, instances, caps[i].firstIndex, 0, 0u);
}
