// What the passes of pcf_hybrid share.
#ifndef GNOMON_HYBRID_PCF_HYBRID_H
#define GNOMON_HYBRID_PCF_HYBRID_H
#include "../maps/map_look.h"

GN_SHARED_BEGIN

struct HybridConstants {
    MapConstants base;
    uint capacity; // pixels the list holds
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_OFFSET(HybridConstants, capacity, 384)
GN_SHARED_SIZE(HybridConstants, 400)

// A pixel in the list: 16 bits of x, 16 of y, in image coordinates.
GN_SHARED_FN uint packPixel(uint x, uint y) { return x | (y << 16u); }
GN_SHARED_FN uint pixelX(uint packedPixel) { return packedPixel & 0xffffu; }
GN_SHARED_FN uint pixelY(uint packedPixel) { return packedPixel >> 16u; }

GN_SHARED_END
#endif
