#version 460
// Least and greatest value, edge by edge, of blocks of functions (WarpTable).
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 2, std430) buffer Tables { float tables[]; };

void main()
{
    uint edge = gl_GlobalInvocationID.x, at = gl_GlobalInvocationID.y, map = gl_WorkGroupID.z;
    WarpTable t = warpTable(map, warp.base.map.side);
    if (edge >= t.edges || at >= 2u * t.blocks || !hasWarpMap(warp, map)) return;
    if (tables.length() < t.first + t.size || !(tables[t.first + t.seen] > 0.0)) return;
    uint kind = at / t.blocks, block = at - kind * t.blocks; // 0 along rows, 1 along columns
    uint level = 1u;
    for (uint i = 0u; i < WARP_CELL_STEPS; ++i)
        if (block >= firstBlock(t, level + 1u) && (2u << level) < t.cells) ++level;
    uint first = (block - firstBlock(t, level)) << level;
    float least = 1.0, greatest = 0.0;
    for (uint i = 0u; i < WARP_MOST_CELLS; ++i) {
        if (i >> level > 0u) break;
        float value = tables[t.first + (kind * t.cells + min(first + i, t.cells - 1u)) * t.edges + edge];
        least = min(least, value);
        greatest = max(greatest, value);
    }
    uint to = t.first + t.bounds + (2u * kind * t.blocks + block) * t.edges + edge;
    tables[to] = least;
    tables[to + t.blocks * t.edges] = greatest;
}
