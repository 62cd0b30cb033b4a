// Constants of pcss's resolve.
#ifndef GNOMON_FILTERED_PCSS_H
#define GNOMON_FILTERED_PCSS_H
#include "../shared/blocker_search.h"
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// std140.
struct PcssConstants {
    MapConstants base;
    DiscCone disc;
    uint taps;
    uint early;   // 1: what the pyramid answers is not searched
    uint reasons; // 1: visibility shows why, not what
    uint padding;
};
GN_SHARED_OFFSET(PcssConstants, disc, 416)
GN_SHARED_SIZE(PcssConstants, 448)

// With the setting `reasons` the byte in visibility is one of these.
GN_SHARED_CONST uint SOFT_DECIDED = 1u;  // sky, out of reach, or facing away
GN_SHARED_CONST uint SOFT_LIT = 2u;      // the pyramid: nothing in the cone is nearer than the receiver
GN_SHARED_CONST uint SOFT_DARK = 3u;     // the pyramid: all of it is
GN_SHARED_CONST uint SOFT_EMPTY = 4u;    // searched: no blocker
GN_SHARED_CONST uint SOFT_FILTERED = 5u; // searched and filtered

GN_SHARED_END
#endif
