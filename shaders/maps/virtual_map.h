// Constants of the resolve of a light's virtual map.
#ifndef GNOMON_MAPS_VIRTUAL_MAP_H
#define GNOMON_MAPS_VIRTUAL_MAP_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MAX_PAGE_LEVELS = 16u;

// std140. All levels have the same depths and are turned alike.
struct VirtualMapConstants {
    MapConstants base; // of a map as large as a page with its border, of texels of the finest level
    vec4 parts[MAX_PAGE_LEVELS];    // texel in the window of level i, finest first = xy * texel of the base + zw
    uvec4 windows[MAX_PAGE_LEVELS]; // first entry of the table, pages to a row, rows; w: 0
    uvec4 given[MAX_PAGE_LEVELS];   // x: the level in which receivers of slice i are looked up first
    uint levels;      // at most MAX_PAGE_LEVELS
    uint slices;      // likewise, at least 1
    float footprint;  // of what pixels ask for at linear depth 1, in texels of slice 0; over the map's clip w
    float pageTexels; // a side, without the border
    float border;     // texels around these
    float padding0;
    float padding1;
    float padding2;
};
GN_SHARED_OFFSET(VirtualMapConstants, parts, 416)
GN_SHARED_OFFSET(VirtualMapConstants, levels, 1184)
GN_SHARED_SIZE(VirtualMapConstants, 1216)

GN_SHARED_END
#endif
