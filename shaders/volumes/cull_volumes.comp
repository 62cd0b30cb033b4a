#version 460
#extension GL_GOOGLE_include_directive : require
// Draws or drops volumes, a workgroup each: copies the indirect commands of its sides and caps, with no instance where
// the volume touches nothing that matters.
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
layout(set = 0, binding = 1, std430) readonly buffer Regions {
    UmbraRegion umbrae[UMBRAE];
    VolumeRegion regions[];
};
layout(set = 0, binding = 2, std430) readonly buffer Reached {
    uint count;
    uint needed;
    uint padding[2];
    ReachedBox reached[];
};
layout(set = 0, binding = 3, std430) readonly buffer Sides { Command sides[]; };
layout(set = 0, binding = 4, std430) readonly buffer Caps { Command caps[]; };
layout(set = 0, binding = 5, std430) writeonly buffer CulledSides { Command culledSides[]; };
layout(set = 0, binding = 6, std430) writeonly buffer CulledCaps { Command culledCaps[]; };

shared uint found; // by any invocation: the volume matters

// Looks at every CULL_GROUP-th box, from the invocation's own on, until one is found.
void findReached(uint region)
{
    vec4 planes[SHADOW_PLANES];
    for (uint p = 0; p < SHADOW_PLANES; ++p)
        planes[p] = regions[region].shadow[p];
    uint listed = min(count, uint(reached.length()));
    for (uint i = gl_LocalInvocationIndex; i < listed && atomicOr(found, 0u) == 0u; i += CULL_GROUP) { // bound: reached
        vec3 center = reached[i].center.xyz, halfExtent = reached[i].halfExtent.xyz;
        bool beyond = false;
        for (uint p = 0; p < SHADOW_PLANES; ++p)
            beyond = beyond || boxBeyond(planes[p], center, halfExtent, 0.0);
        if (!beyond) atomicOr(found, 1u);
    }
}

void main()
{
    CullCandidate candidate = constants.candidates[gl_WorkGroupID.x];
    uint umbra = regions[candidate.region].umbra;
    if (gl_LocalInvocationIndex == 0u) found = umbra != NO_UMBRA ? needed >> umbra & 1u : 0u;
    barrier();
    findReached(candidate.region);
    barrier();
    uint instances = found;
    uint endSide = min(candidate.firstSide + candidate.sideCount, uint(sides.length()));
    uint endCap = min(candidate.firstCap + candidate.capCount, uint(caps.length()));
    for (uint i = candidate.firstSide + gl_LocalInvocationIndex; i < endSide; i += CULL_GROUP) // bound: sides
        culledSides[i] = Command(sides[i].indexCount, instances, sides[i].firstIndex, 0, 0u);
    for (uint i = candidate.firstCap + gl_LocalInvocationIndex; i < endCap; i += CULL_GROUP) // bound: caps
        culledCaps[i] = Command(caps[i].indexCount, instances, caps[i].firstIndex, 0, 0u);
}
