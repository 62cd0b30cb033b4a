// Maps whose texels are moved by tables: what their passes share.
//
// "Source" is the plain map, places in texels of `side` to each side; "warped" is the map that is drawn, of as many
// texels. A table holds functions from 0..1 to 0..1 by their values at evenly spaced edges, straight between these. They
// are sums of what is nowhere negative, so that they never fall and keep both ends.
#ifndef GNOMON_WARPED_WARP_H
#define GNOMON_WARPED_WARP_H
#include "../shared/map_lookup.h"
#include "../shared/paraboloid.h"

GN_SHARED_BEGIN

// Importance per axis of a rectilinear warp, and edges of its two functions.
GN_SHARED_CONST uint WARP_BINS = 512u;
GN_SHARED_CONST uint WARP_BIN_EDGES = WARP_BINS + 1u;
GN_SHARED_CONST uint MAX_BLUR_BINS = 64u;

// Cells per side of the counts of a non-orthogonal warp: as many functions along rows, and along columns. Four texels
// each or so; smoothing takes as long as the cube of their number.
GN_SHARED_CONST uint WARP_MOST_CELLS = 128u;
GN_SHARED_CONST uint WARP_CELL_STEPS = 7u; // 2^7 cells
GN_SHARED_FN uint warpCells(float side) { return side < 256.0f ? 32u : side < 512.0f ? 64u : WARP_MOST_CELLS; }
GN_SHARED_CONST uint MAX_SMOOTHING = WARP_MOST_CELLS / 4u;

// Where things are in the tables of non-orthogonal warps, in floats: functions along rows, and along columns, by their
// edges; of either the least and the greatest of blocks of 2, 4, ... functions, up to two of half of them; where each
// function and the next, of rows and of columns, have the middle of each texel, texel by texel; and whether any receiver
// was counted. Numbers of floats are even.
struct WarpTable {
    uint cells;
    uint edges; // of a function
    uint blocks; // of all sizes
    uint texels;
    uint first;  // of this map
    uint bounds; // behind `first`
    uint places;
    uint seen;
    uint size;
};

GN_SHARED_FN WarpTable warpTable(uint map, float side)
{
    WarpTable t;
    t.cells = warpCells(side);
    t.edges = t.cells + 1u;
    t.texels = uint(clamp(side, 1.0f, 16384.0f));
    t.blocks = t.cells - 2u;
    t.bounds = 2u * t.cells * t.edges;
    t.places = t.bounds + 4u * t.blocks * t.edges;
    t.seen = t.places + 4u * t.texels * t.cells;
    t.size = t.seen + 2u;
    t.first = map * t.size;
    return t;
}

// The first block of 2^level functions, level above 0.
GN_SHARED_FN uint firstBlock(WarpTable t, uint level) { return t.cells - (t.cells >> (level - 1u)); }

// Floats of a map's functions before they are smoothed: those along one side, and the weight of each.
GN_SHARED_FN uint warpFunctions(uint cells) { return cells * (cells + 2u); }

// A point light has a map, and a table, for each of six faces or two paraboloids; others have one. Counts and tables of all maps lie one
// behind the other.
GN_SHARED_CONST uint WARP_MAPS = 6u;

// std140.
struct WarpConstants {
    MapConstants base;
    uvec4 pixels;    // x, y, width, height of those that the light may reach
    float blur;      // rectilinear: bins to each side; non-orthogonal: functions to each side
    float evenShare; // importance that is spread evenly, over all other
    float power;     // of importance
    uint mostWeight; // rectilinear: of a receiver, so that no sum overflows; 0: importance is the greatest, not a sum
    uint maps;       // bit i: receivers may lie in map i
    uint padding0;
    uint padding1;
    uint padding2;
    Paraboloid discs[2]; // where maps are paraboloids
    vec4 firstWs;        // xyz: a receiver in direction v is in the first where dot(v, this) >= 0
};
GN_SHARED_OFFSET(WarpConstants, pixels, 416)
GN_SHARED_SIZE(WarpConstants, 608)

GN_SHARED_FN bool hasWarpMap(WarpConstants warp, uint map)
{
    return map < WARP_MAPS && ((warp.maps >> map) & 1u) != 0u;
}

// Floats of a rectilinear warp's table: both functions; the source place of every column and row, twice, as if there were
// a next function; and whether any receiver was counted.
GN_SHARED_CONST uint RECTILINEAR_PLACES = 2u * WARP_BIN_EDGES;
GN_SHARED_FN uint rectilinearTable(float side)
{
    return RECTILINEAR_PLACES + 4u * uint(clamp(side, 0.0f, 16384.0f)) + 2u;
}
GN_SHARED_FN uint rectilinearSeen(float side) { return rectilinearTable(side) - 2u; }

GN_SHARED_END
#endif
