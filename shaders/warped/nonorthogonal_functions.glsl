// The functions of a non-orthogonal warp: x goes by its row, then y by the column that it has come to; between rows, and
// between columns, straight.
#ifndef GNOMON_WARPED_NONORTHOGONAL_FUNCTIONS_GLSL
#define GNOMON_WARPED_NONORTHOGONAL_FUNCTIONS_GLSL
#include "table.glsl"

// Where a function is asked: between which edges.
struct Along {
    uint edge;
    float share;
};

Along alongAt(float at)
{
    float edge = clamp(at, 0.0, 1.0) * float(WARP_CELLS);
    uint before = min(uint(edge), WARP_CELLS - 1u);
    return Along(before, edge - float(before));
}

float functionAt(uint first, Along at) { return mix(tableAt(first + at.edge), tableAt(first + at.edge + 1u), at.share); }

// Between which functions a place across them lies, counted from the middle of the first.
struct Across {
    uint before, after;
    float share;
};

Across acrossAt(float across)
{
    float at = clamp(across * float(WARP_CELLS) - 0.5, 0.0, float(WARP_CELLS - 1u));
    uint before = min(uint(at), WARP_CELLS - 1u);
    return Across(before, min(before + 1u, WARP_CELLS - 1u), at - float(before));
}

// kind: 0 along rows, 1 along columns.
uint functionsOf(uint map, uint kind) { return map * WARP_TABLE + kind * WARP_FUNCTIONS; }

float warpedAlong(uint map, uint kind, float across, float at)
{
    Across between = acrossAt(across);
    Along along = alongAt(at);
    uint first = functionsOf(map, kind);
    return mix(functionAt(first + between.before * WARP_CELL_EDGES, along),
               functionAt(first + between.after * WARP_CELL_EDGES, along), between.share);
}

float edgeValue(uint functions, Across between, uint edge)
{
    uint first = functions + edge;
    return mix(tableAt(first + between.before * WARP_CELL_EDGES), tableAt(first + between.after * WARP_CELL_EDGES),
               between.share);
}

// The inverse of warpedAlong().
float unwarpedAlong(uint map, uint kind, float across, float value)
{
    const uint STEPS = 7u; // 2^7 cells
    Across between = acrossAt(across);
    uint functions = functionsOf(map, kind), edge = 0u;
    for (uint i = 0u; i < STEPS; ++i) {
        uint further = min(edge + (WARP_CELLS >> (i + 1u)), WARP_CELLS - 1u);
        if (edgeValue(functions, between, further) <= value) edge = further;
    }
    float low = edgeValue(functions, between, edge), high = edgeValue(functions, between, edge + 1u);
    return (float(edge) + clamp((value - low) / max(high - low, 1e-20), 0.0, 1.0)) / float(WARP_CELLS);
}

// Places 0..1.
vec2 warped(uint map, vec2 at, float side)
{
    float x = warpedAlong(map, 0u, at.y, at.x);
    return vec2(x, warpedAlong(map, 1u, x, at.y));
}

vec2 unwarped(uint map, vec2 to)
{
    float y = unwarpedAlong(map, 1u, to.x, to.y);
    return vec2(unwarpedAlong(map, 0u, y, to.x), y);
}
#endif
