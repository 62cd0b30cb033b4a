// What blocker_search.glsl is told of a light's disc and of the map that it looks into.
#ifndef GNOMON_SHARED_BLOCKER_SEARCH_H
#define GNOMON_SHARED_BLOCKER_SEARCH_H
#include "types.h"

GN_SHARED_BEGIN

// Taps of the search for blockers.
GN_SHARED_CONST int SEARCH_TAPS = 32;
// Most taps of a filter over the disc: the greatest value of the setting `taps`.
GN_SHARED_CONST uint MAX_SOFT_TAPS = 128u;

struct DiscCone {
    float reach;           // texels by which the light's disc appears spread, per unit of depth from blocker to receiver
    float tangentPerTexel; // width of a texel at 1 m along the map's axis; directional: 0
    float texelWs;         // the same, metres; directional: width of a texel at any distance
    float radius;          // of the light's disc, metres; directional: over the distance
};
GN_SHARED_SIZE(DiscCone, 16)

GN_SHARED_END
#endif
