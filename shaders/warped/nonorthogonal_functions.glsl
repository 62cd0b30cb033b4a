// The functions of a non-orthogonal warp: x goes by its row, then y by the column that it has come to. What lies between
// functions is straight in what they have as source places, so that a texel's is two values of either kind.
#ifndef GNOMON_WARPED_NONORTHOGONAL_FUNCTIONS_GLSL
#define GNOMON_WARPED_NONORTHOGONAL_FUNCTIONS_GLSL
#include "table.glsl"

// Where a function is asked: between which edges.
struct Along {
    uint edge;
    float share;
};

Along alongAt(WarpTable t, float at)
{
    float edge = clamp(at, 0.0, 1.0) * float(t.cells);
    uint before = min(uint(edge), t.cells - 1u);
    return Along(before, edge - float(before));
}

float functionAt(uint first, Along at) { return mix(tableAt(first + at.edge), tableAt(first + at.edge + 1u), at.share); }

// Between which functions a place across them lies, counted from the middle of the first.
struct Across {
    uint before, after;
    float share;
};

Across acrossAt(WarpTable t, float across)
{
    float at = clamp(across * float(t.cells) - 0.5, 0.0, float(t.cells - 1u));
    uint before = min(uint(at), t.cells - 1u);
    return Across(before, min(before + 1u, t.cells - 1u), at - float(before));
}

// kind: 0 along rows, 1 along columns.
uint functionsOf(WarpTable t, uint kind) { return t.first + kind * t.cells * t.edges; }

uint functionCount(float side) { return warpCells(side); }

uint firstPlace(uint map, float side)
{
    WarpTable t = warpTable(map, side);
    return t.first + t.places;
}

#include "places.glsl"

// The source place, 0..1, of a texel's middle.
float placeAlong(uint map, uint kind, Across between, uint texel, float side)
{
    vec2 both = placesOf(map, kind, between.before, min(texel, uint(side) - 1u), side);
    return mix(both.x, both.y, between.share);
}

// The texel for a place. It lies between what the two functions have there; of several the one whose place is nearest.
uint texelAlong(WarpTable t, uint map, uint kind, float across, float at)
{
    const uint STEPS = 14u; // 2^14 texels
    Across between = acrossAt(t, across);
    Along along = alongAt(t, at);
    uint functions = functionsOf(t, kind);
    float a = functionAt(functions + between.before * t.edges, along);
    float b = functionAt(functions + between.after * t.edges, along);
    uint low = min(uint(min(a, b) * float(t.texels)), t.texels - 1u);
    uint high = min(uint(max(a, b) * float(t.texels)), t.texels - 1u);
    for (uint i = 0u; i < STEPS; ++i) {
        if (low >= high) break;
        uint middle = (low + high) / 2u;
        float side = float(t.texels);
        float end = 0.5 * (placeAlong(map, kind, between, middle, side) + placeAlong(map, kind, between, middle + 1u, side));
        if (at > end)
            low = middle + 1u;
        else
            high = middle;
    }
    return low;
}

float acrossOf(WarpTable t, uint texel) { return (float(texel) + 0.5) / float(t.texels); }

// The texel for a place, 0..1.
uvec2 texelOf(uint map, vec2 at, float side)
{
    WarpTable t = warpTable(map, side);
    uint x = texelAlong(t, map, 0u, at.y, at.x);
    return uvec2(x, texelAlong(t, map, 1u, acrossOf(t, x), at.y));
}

// The source place of a texel's middle, in texels.
vec2 placeOf(uint map, uvec2 texel, float side)
{
    WarpTable t = warpTable(map, side);
    float y = placeAlong(map, 1u, acrossAt(t, acrossOf(t, texel.x)), texel.y, side);
    return vec2(placeAlong(map, 0u, acrossAt(t, y), texel.x, side), y) * side;
}

// Whether any receiver is looked up in the map: without, its table holds nothing else.
bool isSeen(uint map, float side)
{
    WarpTable t = warpTable(map, side);
    return tableAt(t.first + t.seen) > 0.0;
}
#endif
