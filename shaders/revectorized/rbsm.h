// Constants of rbsm's resolve.
#ifndef GNOMON_REVECTORIZED_RBSM_H
#define GNOMON_REVECTORIZED_RBSM_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// Most texels that a stair is followed to each side: the greatest value of the setting `longest`.
GN_SHARED_CONST uint MAX_STAIR = 32u;

// std140.
struct RbsmConstants {
    MapConstants base;
    uint mode;    // REVECTORIZE_*
    uint longest; // of revectorizedVisibility()
    uint padding0;
    uint padding1;
};
GN_SHARED_OFFSET(RbsmConstants, mode, 416)
GN_SHARED_SIZE(RbsmConstants, 432)

GN_SHARED_END
#endif
