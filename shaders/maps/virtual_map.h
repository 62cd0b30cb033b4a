// Constants of the resolve of a light's virtual map.
#ifndef GNOMON_MAPS_VIRTUAL_MAP_H
#define GNOMON_MAPS_VIRTUAL_MAP_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MAX_PAGE_LEVELS = 16u;
GN_SHARED_CONST uint MAX_PAGE_FACES = 6u; // of a point light; others have one
GN_SHARED_CONST uint MAX_PAGE_WINDOWS = 96u; // MAX_PAGE_FACES * MAX_PAGE_LEVELS

// std140. All levels have the same depths, and those of a face are turned alike. That of face f and level i, finest
// first, is window f * MAX_PAGE_LEVELS + i.
struct VirtualMapConstants {
    MapConstants base; // of a map as large as a page with its border, of texels of the finest level; of a point light
                       // about the axis of each face
    vec4 parts[MAX_PAGE_WINDOWS];    // texel in the window = xy * texel of the base + zw
    uvec4 windows[MAX_PAGE_WINDOWS]; // first entry of the table, pages to a row, rows; w: 0
    uvec4 given[MAX_PAGE_LEVELS];    // x: the level in which receivers of slice i are looked up first
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
GN_SHARED_OFFSET(VirtualMapConstants, levels, 3744)
GN_SHARED_SIZE(VirtualMapConstants, 3776)

GN_SHARED_END
#endif
