// Maps whose texels are moved by tables: what their passes share.
//
// "Source" is the plain map, places in texels of `side` to each side; "warped" is the map that is drawn, of as many
// texels. A table holds functions from 0..1 to 0..1 by their values at evenly spaced edges, straight between these. They
// are sums of what is nowhere negative, so that they never fall and keep both ends.
#ifndef GNOMON_WARPED_WARP_H
#define GNOMON_WARPED_WARP_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// Importance per axis of a rectilinear warp, and edges of its two functions.
GN_SHARED_CONST uint WARP_BINS = 512u;
GN_SHARED_CONST uint WARP_BIN_EDGES = WARP_BINS + 1u;
GN_SHARED_CONST uint MAX_BLUR_BINS = 64u;

// Cells per side of the counts of a non-orthogonal warp: as many functions along rows, and along columns.
GN_SHARED_CONST uint WARP_CELLS = 128u;
GN_SHARED_CONST uint WARP_CELL_EDGES = WARP_CELLS + 1u;
GN_SHARED_CONST uint MAX_SMOOTHING = WARP_CELLS / 4u;
// Functions that have bounds in common, for boxes across many.
GN_SHARED_CONST uint WARP_BLOCK = 8u;
GN_SHARED_CONST uint WARP_BLOCKS = WARP_CELLS / WARP_BLOCK;

// Of the table of a non-orthogonal warp, in floats: functions along rows, along columns, the bounds of either, and
// whether any receiver was counted.
GN_SHARED_CONST uint WARP_FUNCTIONS = WARP_CELLS * WARP_CELL_EDGES;
GN_SHARED_CONST uint WARP_FUNCTIONS_OF_MAP = WARP_FUNCTIONS + WARP_CELLS; // along one side, and the weight of each
GN_SHARED_CONST uint WARP_BOUNDS = 2u * WARP_BLOCKS * WARP_CELL_EDGES;
GN_SHARED_CONST uint WARP_SEEN = 2u * (WARP_FUNCTIONS + WARP_BOUNDS);
GN_SHARED_CONST uint WARP_TABLE = WARP_SEEN + 1u;

// A point light has a map, and a table, for each of six faces; others have one. Counts and tables of all maps lie one
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
};
GN_SHARED_OFFSET(WarpConstants, pixels, 416)
GN_SHARED_SIZE(WarpConstants, 464)

GN_SHARED_FN bool hasWarpMap(WarpConstants warp, uint map)
{
    return map < WARP_MAPS && ((warp.maps >> map) & 1u) != 0u;
}

// Floats of a rectilinear warp's table: both functions, the source place of every column and row, and whether any
// receiver was counted.
GN_SHARED_FN uint rectilinearTable(float side)
{
    return 2u * (WARP_BIN_EDGES + uint(clamp(side, 0.0f, 16384.0f))) + 1u;
}

GN_SHARED_END
#endif
