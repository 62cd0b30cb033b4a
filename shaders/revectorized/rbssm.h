// Constants of rbssm's resolve.
#ifndef GNOMON_REVECTORIZED_RBSSM_H
#define GNOMON_REVECTORIZED_RBSSM_H
#include "../shared/blocker_search.h"
#include "../shared/map_lookup.h"
#include "lines.h"

GN_SHARED_BEGIN

// std140.
struct RbssmConstants {
    MapConstants base;
    DiscCone disc;
    uint taps;    // of penumbrae that are wider than `kernel`
    uint kernel;  // most taps to a side that are revectorized
    uint longest; // texels that a stair is followed to each side
    uint padding;
};
GN_SHARED_OFFSET(RbssmConstants, disc, 416)
GN_SHARED_SIZE(RbssmConstants, 448)

GN_SHARED_END
#endif
