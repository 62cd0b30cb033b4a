#version 460
// The counts as they lie once rows are warped, column by column: what a cell holds is spread over the columns that it
// comes to lie in. An invocation a row.
#extension GL_GOOGLE_include_directive : require
#include "table.glsl"

layout(local_size_x = 16) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 1, std430) readonly buffer Counts { uint counts[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Warped { float warpedCounts[]; };

float countAt(uint cell)
{
    return pow(float(counts[min(cell, counts.length() - 1u)]), clamp(warp.power, 0.1, 1.0));
}

const uint STEPS = 2u * WARP_CELLS; // each ends a cell or a column

void main()
{
    uint row = gl_GlobalInvocationID.x, map = gl_WorkGroupID.z;
    if (row >= WARP_CELLS || !hasWarpMap(warp, map)) return;
    uint edges = map * WARP_TABLE + row * WARP_CELL_EDGES, cells = (map * WARP_CELLS + row) * WARP_CELLS;
    uint cell = 0u, column = 0u;
    float low = 0.0, begin = 0.0, held = 0.0;
    float end = tableAt(edges + 1u), count = countAt(cells);
    for (uint i = 0u; i < STEPS; ++i) {
        float columnEnd = float(column + 1u) / float(WARP_CELLS);
        bool cellEnds = end < columnEnd && cell + 1u < WARP_CELLS;
        float high = cellEnds ? end : columnEnd;
        held += count * clamp((high - low) / max(end - begin, 1e-20), 0.0, 1.0);
        low = high;
        if (cellEnds) {
            ++cell;
            begin = end;
            end = tableAt(edges + cell + 1u);
            count = countAt(cells + cell);
        } else if (column < WARP_CELLS) {
            uint to = (map * WARP_CELLS + column) * WARP_CELLS + row;
            if (to < warpedCounts.length()) warpedCounts[to] = held;
            ++column;
            held = 0.0;
        }
    }
}
