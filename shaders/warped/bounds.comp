#version 460
// Least and greatest value, edge by edge, of every WARP_BLOCK functions and of the one to each side, since values are
// straight between functions.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 2, std430) buffer Tables { float tables[]; };

const uint WITH_NEIGHBOURS = WARP_BLOCK + 2u;

void main()
{
    uint edge = gl_GlobalInvocationID.x, block = gl_GlobalInvocationID.y;
    uint map = gl_WorkGroupID.z, table = map * WARP_TABLE;
    if (edge >= WARP_CELL_EDGES || block >= 2u * WARP_BLOCKS || !hasWarpMap(warp, map)) return;
    if (tables.length() < table + WARP_TABLE) return;
    uint kind = block / WARP_BLOCKS; // 0 along rows, 1 along columns
    uint first = (block - kind * WARP_BLOCKS) * WARP_BLOCK;
    float least = 1.0, greatest = 0.0;
    for (uint i = 0u; i < WITH_NEIGHBOURS; ++i) {
        uint function = min(max(first + i, 1u) - 1u, WARP_CELLS - 1u);
        float value = tables[table + kind * WARP_FUNCTIONS + function * WARP_CELL_EDGES + edge];
        least = min(least, value);
        greatest = max(greatest, value);
    }
    uint to = table + 2u * WARP_FUNCTIONS + 2u * (block * WARP_CELL_EDGES + edge);
    tables[to] = least;
    tables[to + 1u] = greatest;
}
