#version 460
// The source places of the columns and rows of a rectilinear map: the inverse of its two functions.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 2, std430) buffer Tables { float tables[]; };

const uint STEPS = 9u; // 2^9 bins

void main()
{
    uint side = uint(warp.base.map.side), me = gl_GlobalInvocationID.x, map = gl_WorkGroupID.z;
    uint table = map * rectilinearTable(warp.base.map.side);
    uint axis = me < side ? 0u : 1u, texel = me - axis * side;
    uint to = table + RECTILINEAR_PLACES + 2u * me;
    if (texel >= side || to + 1u >= tables.length() || !hasWarpMap(warp, map)) return;
    float wanted = (float(texel) + 0.5) / float(side);
    uint first = table + axis * WARP_BIN_EDGES, bin = 0u;
    for (uint i = 0u; i < STEPS; ++i) {
        uint further = min(bin + (WARP_BINS >> (i + 1u)), WARP_BINS - 1u);
        if (tables[first + further] <= wanted) bin = further;
    }
    float low = tables[first + bin], high = tables[first + bin + 1u];
    float share = clamp((wanted - low) / max(high - low, 1e-20), 0.0, 1.0);
    tables[to] = tables[to + 1u] = (float(bin) + share) / float(WARP_BINS);
}
