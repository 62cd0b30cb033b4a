// What a host's shader needs to look up one light's shadows: sample_shadow.glsl reads it, gnGetSampledShadows() writes
// it.
#ifndef GNOMON_SHARED_SHADOW_SAMPLE_H
#define GNOMON_SHARED_SHADOW_SAMPLE_H
#include "map_look.h"

GN_SHARED_BEGIN

// How the layers of a map lie about its light.
GN_SHARED_CONST uint SAMPLE_NOTHING = 0u; // there is no map: lit
GN_SHARED_CONST uint SAMPLE_MATRIX = 1u;  // one layer, one matrix
GN_SHARED_CONST uint SAMPLE_PARTS = 2u;   // a directional light's, about parts of what is seen, finest first
GN_SHARED_CONST uint SAMPLE_CUBE = 3u;    // the six faces of a cube
GN_SHARED_CONST uint SAMPLE_DISCS = 4u;   // one or two paraboloids

GN_SHARED_CONST uint MAX_SAMPLE_PARTS = 6u;
GN_SHARED_CONST uint SAMPLE_VECTORS = 9u;

// std140 and std430 alike.
struct ShadowSample {
    MapLookup map;
    vec4 parts[SAMPLE_VECTORS]; // parts: texel of i = xy * texel of the finest + zw. Discs: two Paraboloids, and a
                                // vector v: what lies at p from the light is in the first where dot(v, p) >= 0
    vec4 eye;                   // xyz: the zero of `map` in the host's coordinates; w: radius of the light's disc, 1 m off
    vec4 ahead;                 // linear depth of what lies at v from there: dot(xyz, v) + w
    uint kind;                  // SAMPLE_*
    uint count;                 // of parts
    float lastLayer;            // of the last part; part i before it is layer i
    float border;               // texels: a receiver nearer to a part's edge is looked up in the next
};
GN_SHARED_OFFSET(ShadowSample, parts, 240)
GN_SHARED_OFFSET(ShadowSample, kind, 416)
GN_SHARED_SIZE(ShadowSample, 432)

GN_SHARED_END
#endif
