#version 460
// Functions averaged with their neighbours, by a tent and by how many receivers each stands for. Weights do not depend on
// the place along the function, so that averages never fall either, and keep both ends. An invocation an edge.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 1, std430) readonly buffer Functions { float functions[]; };
layout(set = 0, binding = 2, std430) buffer Tables { float tables[]; };
#ifdef COLUMNS
const uint FIRST = WARP_FUNCTIONS;
#else
const uint FIRST = 0u;
#endif

float functionAt(uint at) { return functions[min(at, functions.length() - 1u)]; }

#ifndef COLUMNS
bool anyWeight(uint first)
{
    float sum = 0.0;
    for (uint i = 0u; i < WARP_CELLS; ++i)
        sum += functionAt(first + i);
    return sum > 0.0;
}
#endif

void main()
{
    uint edge = gl_GlobalInvocationID.x, me = gl_GlobalInvocationID.y, map = gl_WorkGroupID.z;
    uint table = map * WARP_TABLE, from = map * WARP_FUNCTIONS_OF_MAP;
    uint to = table + FIRST + me * WARP_CELL_EDGES + edge;
    if (edge >= WARP_CELL_EDGES || me >= WARP_CELLS || !hasWarpMap(warp, map)) return;
    if (tables.length() < table + WARP_TABLE) return;
#ifndef COLUMNS
    if (edge == 0u && me == 0u) tables[table + WARP_SEEN] = anyWeight(from + WARP_FUNCTIONS) ? 1.0 : 0.0;
#endif
    uint radius = min(uint(max(warp.blur, 0.0)), MAX_SMOOTHING);
    float weights = 0.0, sum = 0.0;
    for (uint i = 0u; i <= 2u * radius; ++i) { // bound: MAX_SMOOTHING
        uint other = me + i - radius;          // before 0 it is beyond the end
        if (other >= WARP_CELLS) continue;
        float tent = float(radius + 1u) - abs(float(i) - float(radius));
        float weight = tent * functionAt(from + WARP_FUNCTIONS + other);
        weights += weight;
        sum += weight * functionAt(from + other * WARP_CELL_EDGES + edge);
    }
    float even = float(edge) / float(WARP_CELLS);
    tables[to] = edge == WARP_CELLS ? 1.0 : weights > 0.0 ? clamp(sum / weights, 0.0, 1.0) : even;
}
