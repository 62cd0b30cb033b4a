// What the passes of ray_soft are told.
#ifndef GNOMON_HYBRID_RAY_SOFT_H
#define GNOMON_HYBRID_RAY_SOFT_H
#include "ray_query.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint SOFT_RAYS = 4u; // a pixel and frame, at most
GN_SHARED_CONST int SOFT_TILE = 8;   // pixels along a side of a tile

// Bits of RaySoftConstants::state.x.
GN_SHARED_CONST uint SOFT_HAS_PAST = 1u; // the history is of this view and light
GN_SHARED_CONST uint SOFT_MOVED = 2u;    // the light or casters have changed since
GN_SHARED_CONST uint SOFT_WEIGHTED = 4u; // points count as they shine on a diffuse receiver, not by area
GN_SHARED_CONST uint SOFT_MOTION = 8u;   // motion vectors lead to it

// std140.
struct RaySoftConstants {
    RayQueryConstants base;
    uvec4 state; // x: bits; y: rays a pixel and frame; z: the sequence's first number; w: which of SoftCameras::views the history is of
    vec4 disc;   // x: radius of the light's disc over the length of the ray to its centre, 1 for directional lights; y: frames
                 // whose rays count at most; z: rays a pixel in this frame, more in a first one
    vec4 sourceX; // xyz: half axes of a flat source, metres; zero: a sphere. w: 1 of a disc, 0 of a rectangle
    vec4 sourceY;
    vec4 motion; // xyz: GnViewFrame::motionScale
};
GN_SHARED_OFFSET(RaySoftConstants, state, 256)
GN_SHARED_SIZE(RaySoftConstants, 336)

GN_SHARED_END
#endif
