// Constants of area_light's resolve.
#ifndef GNOMON_AREA_AREA_LIGHT_H
#define GNOMON_AREA_AREA_LIGHT_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// Most maps that one pass looks up: their constants are half of the 16384 bytes that every device binds.
GN_SHARED_CONST uint MAX_AREA_MAPS = 32u;

// std140.
struct AreaConstants {
    MapConstants base;               // of the light's centre; no projection
    MapLookup points[MAX_AREA_MAPS]; // of the points whose maps are in the layers
    uint count;                      // of those
    float share;                     // of the source that each point stands for
    uint continues;                  // 1: other passes have summed up other points
    uint needed;                     // bits: those of the points that are looked up, where a word is kept of them
    vec4 gapX;                       // of gap_kernel.glsl, xyz: from a point to the next, metres; directional: tangent
    vec4 gapY;                       // and to the next across
};
GN_SHARED_OFFSET(AreaConstants, points, 416)
GN_SHARED_OFFSET(AreaConstants, count, 8096)
GN_SHARED_SIZE(AreaConstants, 8144)

GN_SHARED_END
#endif
