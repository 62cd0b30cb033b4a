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
const uint KIND = 1u;
#else
const uint KIND = 0u;
#endif

float functionAt(uint at) { return functions[min(at, functions.length() - 1u)]; }

#ifndef COLUMNS
bool anyWeight(uint first, uint cells)
{
    float sum = 0.0;
    for (uint i = 0u; i < WARP_MOST_CELLS; ++i) {
        if (i >= cells) break;
        sum += functionAt(first + i);
    }
    return sum > 0.0;
}
#endif

void main()
{
    uint edge = gl_GlobalInvocationID.x, me = gl_GlobalInvocationID.y, map = gl_WorkGroupID.z;
    WarpTable t = warpTable(map, warp.base.map.side);
    if (edge >= t.edges || me >= t.cells || !hasWarpMap(warp, map) || tables.length() < t.first + t.size) return;
    uint from = map * warpFunctions(t.cells), weightsFrom = from + t.cells * t.edges;
#ifdef COLUMNS
    if (!(tables[t.first + t.seen] > 0.0)) return;
#else
    if (edge == 0u && me == 0u) tables[t.first + t.seen] = anyWeight(weightsFrom, t.cells) ? 1.0 : 0.0;
#endif
    uint radius = min(uint(max(warp.blur, 0.0)), MAX_SMOOTHING);
    float weights = 0.0, sum = 0.0;
    for (uint i = 0u; i <= 2u * radius; ++i) { // bound: MAX_SMOOTHING
        uint other = me + i - radius;          // before 0 it is beyond the end
        if (other >= t.cells) continue;
        float tent = float(radius + 1u) - abs(float(i) - float(radius));
        float weight = tent * functionAt(weightsFrom + other);
        weights += weight;
        sum += weight * functionAt(from + other * t.edges + edge);
    }
    float even = float(edge) / float(t.cells);
    uint to = t.first + (KIND * t.cells + me) * t.edges + edge;
    tables[to] = edge == t.cells ? 1.0 : weights > 0.0 ? clamp(sum / weights, 0.0, 1.0) : even;
}
