#version 460
// One function for every row of counts, or (COLUMNS) for every column of those warped along rows: running sums. An
// invocation a function.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 16) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
#ifdef COLUMNS
layout(set = 0, binding = 1, std430) readonly buffer Counts { float counts[]; };
float countAt(uint cell) { return counts[min(cell, counts.length() - 1u)]; }
#else
layout(set = 0, binding = 1, std430) readonly buffer Counts { uint counts[]; };
float countAt(uint cell)
{
    return pow(float(counts[min(cell, counts.length() - 1u)]), clamp(warp.power, 0.1, 1.0));
}
#endif
// Edges of all functions, then the weight of each.
layout(set = 0, binding = 2, std430) writeonly buffer Functions { float functions[]; };

void put(uint at, float value)
{
    if (at < functions.length()) functions[at] = value;
}

void main()
{
    uint me = gl_GlobalInvocationID.x, map = gl_WorkGroupID.z, cells = warpCells(warp.base.map.side);
    if (me >= cells || !hasWarpMap(warp, map)) return;
    uint first = (map * cells + me) * cells, to = map * warpFunctions(cells), edges = to + me * (cells + 1u);
    float total = 0.0;
    for (uint k = 0u; k < WARP_MOST_CELLS; ++k) {
        if (k >= cells) break;
        total += countAt(first + k);
    }
    float even = clamp(warp.evenShare, 0.0, 1e3) * total / float(cells);
    float all = total + even * float(cells);
    bool empty = !(all > 0.0);
    float sum = 0.0;
    for (uint k = 0u; k < WARP_MOST_CELLS; ++k) {
        if (k >= cells) break;
        put(edges + k, empty ? float(k) / float(cells) : min(sum / all, 1.0));
        sum += countAt(first + k) + even;
    }
    put(edges + cells, 1.0);
    put(to + cells * (cells + 1u) + me, empty ? 0.0 : total);
}
