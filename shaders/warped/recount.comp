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

const uint STEPS = 2u * WARP_MOST_CELLS; // each ends a cell or a column

void main()
{
    uint row = gl_GlobalInvocationID.x, map = gl_WorkGroupID.z;
    WarpTable t = warpTable(map, warp.base.map.side);
    if (row >= t.cells || !hasWarpMap(warp, map)) return;
    uint edges = t.first + row * t.edges, cells = (map * t.cells + row) * t.cells;
    bool seen = tableAt(t.first + t.seen) > 0.0; // without, there are no functions either
    uint cell = 0u, column = 0u;
    float low = 0.0, begin = 0.0, held = 0.0;
    float end = seen ? tableAt(edges + 1u) : 1.0, count = countAt(cells);
    for (uint i = 0u; i < STEPS; ++i) {
        if (column >= t.cells) break;
        float columnEnd = float(column + 1u) / float(t.cells);
        bool cellEnds = seen && end < columnEnd && cell + 1u < t.cells;
        float high = cellEnds ? end : columnEnd;
        held += count * clamp((high - low) / max(end - begin, 1e-20), 0.0, 1.0);
        low = high;
        if (cellEnds) {
            ++cell;
            begin = end;
            end = tableAt(edges + cell + 1u);
            count = countAt(cells + cell);
        } else {
            uint to = (map * t.cells + column) * t.cells + row;
            if (to < warpedCounts.length()) warpedCounts[to] = held;
            ++column;
            held = 0.0;
        }
    }
}
