// Constants of the resolve of a directional light with several maps.
#ifndef GNOMON_MAPS_CASCADES_H
#define GNOMON_MAPS_CASCADES_H
#include "../shared/map_lookup.h"
#include "../shared/shadow_sample.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MAX_CASCADES = MAX_SAMPLE_PARTS;

// std140. All maps have the same depths and are turned alike: a place in one is a place in another scaled and moved.
struct CascadesConstants {
    MapConstants base;        // of the finest map
    vec4 parts[MAX_CASCADES]; // texel of map i = xy * texel of the finest + zw; finest first
    uint count;               // maps
    float lastLayer;          // of the last one; map i before it is layer i
    float border;             // texels: a receiver nearer to a map's edge is looked up in the next
    float padding;
};
GN_SHARED_OFFSET(CascadesConstants, count, 512)
GN_SHARED_SIZE(CascadesConstants, 528)

GN_SHARED_END
#endif
