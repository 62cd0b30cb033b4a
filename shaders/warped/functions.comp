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
    uint me = gl_GlobalInvocationID.x, map = gl_WorkGroupID.z;
    if (me >= WARP_CELLS || !hasWarpMap(warp, map)) return;
    uint first = (map * WARP_CELLS + me) * WARP_CELLS, to = map * WARP_FUNCTIONS_OF_MAP;
    float total = 0.0;
    for (uint k = 0u; k < WARP_CELLS; ++k)
        total += countAt(first + k);
    float even = clamp(warp.evenShare, 0.0, 1e3) * total / float(WARP_CELLS);
    float all = total + even * float(WARP_CELLS);
    bool empty = !(all > 0.0);
    float sum = 0.0;
    for (uint k = 0u; k < WARP_CELLS; ++k) {
        put(to + me * WARP_CELL_EDGES + k, empty ? float(k) / float(WARP_CELLS) : min(sum / all, 1.0));
        sum += countAt(first + k) + even;
    }
    put(to + me * WARP_CELL_EDGES + WARP_CELLS, 1.0);
    put(to + WARP_FUNCTIONS + me, empty ? 0.0 : total);
}
