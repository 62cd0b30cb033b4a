// Constants of rbsm's resolve.
#ifndef GNOMON_REVECTORIZED_RBSM_H
#define GNOMON_REVECTORIZED_RBSM_H
#include "../maps/map_look.h"

GN_SHARED_BEGIN

// std140.
struct RbsmConstants {
    MapConstants base;
    uint mode;    // REVECTORIZE_*
    uint longest; // of revectorizedVisibility()
    uint padding0;
    uint padding1;
};
GN_SHARED_OFFSET(RbsmConstants, mode, 384)
GN_SHARED_SIZE(RbsmConstants, 400)

GN_SHARED_END
#endif
