// The draws that make visibility of counts.
#ifndef GNOMON_VOLUMES_RESOLVE_H
#define GNOMON_VOLUMES_RESOLVE_H
#include "receiver_tile.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint RESOLVE_DARK = 0u;      // where the stencil is not 0, if that decides: nothing is shaded
GN_SHARED_CONST uint RESOLVE_COUNTED = 1u;   // where it is not 0, in all other tiles
GN_SHARED_CONST uint RESOLVE_UNCOUNTED = 2u; // where it is 0: surfaces that face away are dark all the same
GN_SHARED_CONST uint RESOLVE_PARTS = 3u;

// Whether a draw has to cover a tile.
//   answer  of tileAnswer()
GN_SHARED_FN bool partCovers(uint part, uint answer, VolumeResolve resolve)
{
    if (answer == TILE_UNREACHED) return false; // 1, as cleared
    bool turned = (answer & TILE_TURNED) != 0u;
    if (part == RESOLVE_UNCOUNTED) return turned;
    bool decides = (answer & TILE_PARTLY) == 0u && (!turned || resolve.shadow == resolve.turnedAway);
    return decides == (part == RESOLVE_DARK);
}

GN_SHARED_END
#endif
