// Constants of the resolve of maps whose edges are lines.
#ifndef GNOMON_REVECTORIZED_LINES_H
#define GNOMON_REVECTORIZED_LINES_H
#include "../shared/map_lookup.h"
#include "stairs.h"

GN_SHARED_BEGIN

// std140.
struct LineConstants {
    MapConstants base;
    uint mode;    // REVECTORIZE_*
    uint longest; // of revectorizedVisibility()
    uint padding0;
    uint padding1;
};
GN_SHARED_OFFSET(LineConstants, mode, 416)
GN_SHARED_SIZE(LineConstants, 432)

GN_SHARED_END
#endif
