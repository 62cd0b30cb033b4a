#version 460
// Where each function of a non-orthogonal warp and the next have the middle of each texel: their inverse.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 2, std430) buffer Tables { float tables[]; };

void main()
{
    uint me = gl_GlobalInvocationID.x, kind = gl_WorkGroupID.y, map = gl_WorkGroupID.z;
    WarpTable t = warpTable(map, warp.base.map.side);
    uint texel = me / t.cells, function = me - texel * t.cells;
    if (texel >= t.texels || kind > 1u || !hasWarpMap(warp, map)) return;
    if (tables.length() < t.first + t.size || !(tables[t.first + t.seen] > 0.0)) return;
    float wanted = (float(texel) + 0.5) / float(t.texels);
    uint first = t.first + (kind * t.cells + function) * t.edges, edge = 0u;
    for (uint i = 0u; i < WARP_CELL_STEPS; ++i) {
        uint further = min(edge + (WARP_MOST_CELLS >> (i + 1u)), t.cells - 1u);
        if (tables[first + further] <= wanted) edge = further;
    }
    float low = tables[first + edge], high = tables[first + edge + 1u];
    float share = clamp((wanted - low) / max(high - low, 1e-20), 0.0, 1.0);
    float place = (float(edge) + share) / float(t.cells);
    uint to = t.first + t.places + 2u * (kind * t.texels * t.cells + me);
    tables[to] = place;
    if (function > 0u) tables[to - 1u] = place; // the one before has it as its next
    if (function + 1u == t.cells) tables[to + 1u] = place;
}
