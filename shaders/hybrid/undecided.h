// How the pixels that wait for their rays are found on the device.
#ifndef GNOMON_HYBRID_UNDECIDED_H
#define GNOMON_HYBRID_UNDECIDED_H
#include "../shared/receiver.h"
#include "reasons.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint LISTED_SIDE = 4u;    // pixels of a tile in the list; LISTED_PIXELS is its square
GN_SHARED_CONST uint LISTED_PIXELS = 16u; // bits of its mask
GN_SHARED_CONST uint LISTED_GROUP = 8u;   // tiles a side that a workgroup looks at

// std140 and std430 alike.
struct UndecidedConstants {
    ViewConstants view;
    uvec4 pixels;    // what the light reaches: x, y, width, height
    uvec4 doubted;   // where the byte `doubt` counts as UNDECIDED: first pixel and, in zw, the one past the last
    vec4 boxLowerWs; // and of receivers in this box alone; relative to the frame's origin
    vec4 boxUpperWs;
    uvec4 doubt; // x: the byte
};
GN_SHARED_OFFSET(UndecidedConstants, pixels, 176)
GN_SHARED_SIZE(UndecidedConstants, 256)

GN_SHARED_END
#endif
