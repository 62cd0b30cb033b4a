// Constants of the passes that choose points of a source by a quadtree. A place is a bit of a word: 32 times the word's
// layer, and the bit.
#ifndef GNOMON_AREA_QUADS_H
#define GNOMON_AREA_QUADS_H
#include "../shared/types.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MAX_QUADS = 64u;
GN_SHARED_CONST uint MAX_POINTS = 289u;
GN_SHARED_CONST uint QUAD_GROUP = 8u;  // invocations of a workgroup in x and in y
GN_SHARED_CONST uint RAMP_CODES = 15u; // what is kept of a point with RAMPS: 0 hidden, 15 seen, between: on a ramp

// std140.
struct QuadTests {
    uvec4 corners[MAX_QUADS]; // places
    uvec4 area;               // pixels drawn: x, y, width, height
    uint count;
    uint window; // pixels from one that is looked at to the next
    uint firstFlag;
    uint ramps; // so many corners on a ramp show no step
};
GN_SHARED_SIZE(QuadTests, 1056)

// std140.
struct PointWeights {
    uvec4 points[(MAX_POINTS + 1u) / 2u]; // two of each: place, and weight as the bits of a float
    uint count;
    float shown; // visibility everywhere, where it is not negative
    uint padding0;
    uint padding1;
};
GN_SHARED_SIZE(PointWeights, 2336)

GN_SHARED_END
#endif
