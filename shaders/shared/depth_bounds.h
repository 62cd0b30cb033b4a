// The pyramid of nearest and farthest depths in squares of texels of a map: squares of 4 texels a side, then of 16, and
// so on to a single one that holds them all. A layer after the other; of each the finest level first, row by row.
#ifndef GNOMON_SHARED_DEPTH_BOUNDS_H
#define GNOMON_SHARED_DEPTH_BOUNDS_H
#include "types.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint BOUNDS_STEP = 4u;  // side of a square in squares of the level below, or in texels
GN_SHARED_CONST uint BOUNDS_LEVELS = 7u; // of maps of up to 4^7 texels a side
GN_SHARED_CONST uint BOUNDS_GROUP = 8u;  // side of a workgroup

struct DepthBoundsPush {
    uint side;    // of the level below, squares, or of the map
    uint below;   // where that begins, squares
    uint first;   // where this level begins
    uint fromMap; // 1: the level below is the map
};
GN_SHARED_SIZE(DepthBoundsPush, 16)

// Squares a row of the level above one of `side` squares or texels.
GN_SHARED_FN uint boundsSide(uint side) { return (side + BOUNDS_STEP - 1u) / BOUNDS_STEP; }

GN_SHARED_END
#endif
