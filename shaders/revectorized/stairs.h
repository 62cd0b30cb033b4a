// What is made of the stairs along a map's edges. Also part of what hosts include (sample_shadow.glsl).
#ifndef GNOMON_REVECTORIZED_STAIRS_H
#define GNOMON_REVECTORIZED_STAIRS_H
#include "../shared/types.h"

GN_SHARED_BEGIN

// Most texels that a stair is followed to each side: the greatest value of the setting `longest`.
GN_SHARED_CONST uint MAX_STAIR = 32u;
// Most taps to a side of a kernel.
GN_SHARED_CONST uint MAX_LINE_TAPS = 15u;

// What is made of stairs: values of `mode`.
GN_SHARED_CONST uint REVECTORIZE_CONSERVATIVE = 0u;    // lines through the shadow's corners: it only grows (Eq 3.6)
GN_SHARED_CONST uint REVECTORIZE_NONCONSERVATIVE = 1u; // lines through the middles of its stairs (Eqs 3.7 to 3.9)
GN_SHARED_CONST uint REVECTORIZE_FILTERED = 2u;        // a ramp about the same lines, a texel to either side (Eq 4.2)
GN_SHARED_CONST uint REVECTORIZE_KERNEL = 3u;          // the mean of such ramps over a box (line_kernel.h)

GN_SHARED_END
#endif
