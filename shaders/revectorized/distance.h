// Penumbrae by distances from the edges of a hard shadow: what its passes share. Source: Macedo 2018, 4.2 and 5.2.
#ifndef GNOMON_REVECTORIZED_DISTANCE_H
#define GNOMON_REVECTORIZED_DISTANCE_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// Longest side of a rectangle of pixels: squares of distances and their differences fit into an int, and a place fits
// into 16 bits a coordinate.
GN_SHARED_CONST uint MAX_DISTANCE_SIDE = 16384u;
GN_SHARED_CONST uint MAX_DISTANCE_STEPS = 32768u;
GN_SHARED_CONST uint DISTANCE_GROUP = 32u;
// No pixel is a site. Sites are column | row << 16, in pixels of the rectangle.
GN_SHARED_CONST uint NO_SITE = 0xffffffffu;

// Push constants of the distance transform: the rectangle in the image of seeds.
struct DistanceRect {
    uint left;
    uint top;
    uint width;
    uint height;
};

// std140.
struct DistanceConstants {
    MapConstants base;
    uvec4 rect;  // DistanceRect
    float width; // of penumbrae, metres; 0: by the depths of what casts the shadow
    float disc;  // half width of the light's disc, metres; directional: over the distance
    uint show;   // SHOW_*
    float mean;  // width of the mean that is taken of the ramp, over the penumbra's; 0: none
};
GN_SHARED_OFFSET(DistanceConstants, rect, 416)
GN_SHARED_SIZE(DistanceConstants, 448)

// What is in visibility.
GN_SHARED_CONST uint SHOW_VISIBILITY = 0u;
GN_SHARED_CONST uint SHOW_SEEDS = 1u;   // 255 where a pixel is a site, else 0
GN_SHARED_CONST uint SHOW_COLUMNS = 2u; // of the nearest site, and 1; 0: there is none
GN_SHARED_CONST uint SHOW_ROWS = 3u;

// Steps of bisection for an edge between two pixels: a 16th of a pixel, and half of that from its middle.
GN_SHARED_CONST int EDGE_STEPS = 4;

// States of a pixel under the hard shadow, as a byte image has them.
GN_SHARED_CONST float STATE_DARK = 1.0f / 3.0f; // and 0 and 1 where no caster matters
GN_SHARED_CONST float STATE_LIT = 2.0f / 3.0f;

// Texels that a stair is followed to each side: rbsm's default.
GN_SHARED_CONST uint LONGEST_STAIR = 16u;
// Texels per side of the window that is searched for what casts the shadow at an edge (Macedo 2018, 5.5.1).
GN_SHARED_CONST int BLOCKER_SIDE = 9;

GN_SHARED_END
#endif
