// Constants of penumbrae that are blurred on the screen (screen_penumbra.glsl, screen_blur.frag).
#ifndef GNOMON_SHARED_SCREEN_PENUMBRA_H
#define GNOMON_SHARED_SCREEN_PENUMBRA_H
#include "blocker_search.h"
#include "map_lookup.h"

GN_SHARED_BEGIN

// Most taps to each side of a pixel in one of the two passes.
GN_SHARED_CONST uint MAX_BLUR_STEPS = 31u;

// std140.
struct ScreenPenumbraConstants {
    MapConstants base;
    uvec4 hard; // what the method's own look-up is told
    DiscCone disc;
    LightConstants light;
    uint steps;        // taps to each side
    float leastCosine; // of the plane to the light, from which on the ellipse does not grow longer; 1: a circle
    uint padding1;
    uint padding2;
};
GN_SHARED_OFFSET(ScreenPenumbraConstants, hard, 416)
GN_SHARED_OFFSET(ScreenPenumbraConstants, light, 448)
GN_SHARED_SIZE(ScreenPenumbraConstants, 512)

// What is not filtered, nor part of what others filter: its visibility, 0 or 1, less this.
GN_SHARED_CONST float NOT_ASKED = 2.0f;

GN_SHARED_END
#endif
