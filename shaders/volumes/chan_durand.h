// What the passes of chan_durand share: its constants, and the cells of the map by which casters are culled.
#ifndef GNOMON_VOLUMES_CHAN_DURAND_H
#define GNOMON_VOLUMES_CHAN_DURAND_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// std140.
struct ChanDurandConstants {
    MapConstants base;
    int widen; // texels by which the four that vote are widened to each side
    int padding0;
    int padding1;
    int padding2;
};
GN_SHARED_OFFSET(ChanDurandConstants, widen, 416)
GN_SHARED_SIZE(ChanDurandConstants, 432)

// A layer of the map is cut into CELLS x CELLS cells. A cell holds depthKey of the farthest silhouette receiver that
// falls into it, or 0. 32: a clear of 4 kB a layer, and cells of 16 texels of a map of 512, smaller than most casters.
GN_SHARED_CONST uint CELLS = 32u;
GN_SHARED_CONST uint MAX_LAYERS = 6u;

// Sorts as map depths do; 0 is kept for "no receiver". Before the near end all is one.
GN_SHARED_FN uint depthKey(float depth)
{
    return max(floatBitsToUint(max(depth, 0.0f)), 1u);
}

// Where in one layer's cells a caster's shadow can fall: corners inclusive, and the least depth it can begin at.
struct CellFootprint {
    uint layer;
    uint lowerX;
    uint lowerY;
    uint upperX;
    uint upperY;
    uint nearestKey;
};

// One indirect command of a list of volumes, and when it is wanted. std430.
struct CullItem {
    uint list;    // 0 static sides, 1 moving sides, 2 static caps, 3 moving caps
    uint command; // in that list
    uint footprintCount;
    CellFootprint footprints[MAX_LAYERS];
};
GN_SHARED_SIZE(CullItem, 156)

GN_SHARED_END
#endif
