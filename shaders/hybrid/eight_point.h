// What eight_point_hybrid's classifying pass is told: a map from each point of the light.
#ifndef GNOMON_HYBRID_EIGHT_POINT_H
#define GNOMON_HYBRID_EIGHT_POINT_H
#include "reasons.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint LIGHT_POINTS = 8u; // Beister, Ernst and Stamminger 2005: the centre and seven around it

struct EightPointConstants {
    HybridConstants hybrid; // its light is the centre with the light's own range and cone
    MapLookup points[8];      // layer i of the map is seen from point i
};
GN_SHARED_OFFSET(EightPointConstants, points, 432)
GN_SHARED_SIZE(EightPointConstants, 2352)

GN_SHARED_END
#endif
