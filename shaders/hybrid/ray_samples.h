// What ray_query is told of a light whose surface it samples.
#ifndef GNOMON_HYBRID_RAY_SAMPLES_H
#define GNOMON_HYBRID_RAY_SAMPLES_H
#include "ray_query.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MOST_SAMPLES = 1024u; // rays a pixel
GN_SHARED_CONST uint SAMPLE_SETS = 16u;    // of points; a pixel takes one of them and turns it by an angle of its own

// std140.
struct RaySamplesConstants {
    RayQueryConstants base;
    uvec4 samples; // x: rays a pixel; y: seed; z: 1 of a rectangle, 0 of a disc; w: rows that the points lie in
    vec4 sourceX;  // xyz: half axes of a flat source, metres; zero: a sphere, or the sun
    vec4 sourceY;  // w: radius of the disc over the length of the ray to its centre
};
GN_SHARED_OFFSET(RaySamplesConstants, samples, 256)
GN_SHARED_SIZE(RaySamplesConstants, 304)

GN_SHARED_END
#endif
