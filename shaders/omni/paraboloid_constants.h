// Constants of the resolve of a point light with maps of paraboloids.
#ifndef GNOMON_OMNI_PARABOLOID_CONSTANTS_H
#define GNOMON_OMNI_PARABOLOID_CONSTANTS_H
#include "../shared/map_lookup.h"
#include "../shared/paraboloid.h"

GN_SHARED_BEGIN

// std140.
struct ParaboloidConstants {
    MapConstants base;
    Paraboloid parts[2];
    vec4 firstWs; // xyz: a receiver in direction v is in part 0 where dot(v, this) >= 0, else in part 1
};
GN_SHARED_OFFSET(ParaboloidConstants, firstWs, 544)
GN_SHARED_SIZE(ParaboloidConstants, 560)

GN_SHARED_END
#endif
