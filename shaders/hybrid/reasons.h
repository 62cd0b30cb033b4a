// What the methods that ask a map first and trace the rest share between their passes: why a pixel is lit or dark.
#ifndef GNOMON_HYBRID_REASONS_H
#define GNOMON_HYBRID_REASONS_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

struct HybridConstants {
    MapConstants base;
    uint reasons; // 1: visibility shows why, not what
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_OFFSET(HybridConstants, reasons, 416)
GN_SHARED_SIZE(HybridConstants, 432)

// Why a pixel is lit or dark: Moderno's record of a pixel, its section 1.3. With the setting `reasons` the byte in
// visibility is the code itself.
GN_SHARED_CONST uint REASON_OUTSIDE = 1u;       // lit: sky, or the light does not reach it
GN_SHARED_CONST uint REASON_BACKFACING = 2u;    // dark: its surface faces away
GN_SHARED_CONST uint REASON_MAP_LIT = 3u;       // the map alone
GN_SHARED_CONST uint REASON_MAP_SHADOW = 4u;
GN_SHARED_CONST uint REASON_TC_LIT = 5u;        // texels agree
GN_SHARED_CONST uint REASON_TC_SHADOW = 6u;
GN_SHARED_CONST uint REASON_NB_CONFIRMED = 7u;  // dark: a neighbouring texel's triangle is hit
GN_SHARED_CONST uint REASON_NB_CORRECTED = 8u;  // dark against the map, by the same candidate occluder
GN_SHARED_CONST uint REASON_AG_CONFIRMED = 9u;  // dark: a triangle beside the texel's own is hit
GN_SHARED_CONST uint REASON_RT_LIT = 10u;       // its own ray
GN_SHARED_CONST uint REASON_RT_SHADOW = 11u;
GN_SHARED_CONST uint REASON_FALLBACK_LIT = 12u; // nobody proved anything, and rays are off
GN_SHARED_CONST uint REASON_TILE_LIT = 13u;     // proved for a whole tile of pixels
GN_SHARED_CONST uint REASON_TILE_SHADOW = 14u;
GN_SHARED_CONST uint REASON_COUNT = 15u;

// The byte in visibility of a pixel that waits for its rays: no reason, not lit, not dark and no eighth in between.
GN_SHARED_CONST uint UNDECIDED = 200u;

// The byte, between contour_chain's passes, of a pixel that the map calls lit for a texel that holds something at or
// before the near end: its bit 0 says lit, and it is asked wherever it is.
GN_SHARED_CONST uint MAP_UNSURE = 127u;

// With `reasons` 2 contour_chain's byte is what each of its stages would say by itself (Moderno's tables 5 to 15 are
// counts of such bytes). Bit 0 is what the map says; then who agrees with it, and whose triangles block the ray.
GN_SHARED_CONST uint VOTE_LIT = 1u;
GN_SHARED_CONST uint VOTE_TC4 = 2u; // the four texels around the receiver agree
GN_SHARED_CONST uint VOTE_TC9 = 4u;
GN_SHARED_CONST uint VOTE_ST = 8u; // the own texel's triangle
GN_SHARED_CONST uint VOTE_NB4 = 16u;
GN_SHARED_CONST uint VOTE_NB9 = 32u;
GN_SHARED_CONST uint VOTE_AG1 = 64u; // the own one's or one that shares an edge with it
GN_SHARED_CONST uint VOTE_AG2 = 128u;
// What asks nobody counts as agreed on, and as proved where it is dark (his 4.4).
GN_SHARED_CONST uint VOTES_OUTSIDE = 7u;
GN_SHARED_CONST uint VOTES_BACKFACING = 254u;

// With `reasons` 3 and 4 the byte is how many triangles a stage could ask (his tables 25 to 197): 3: of four texels plus
// five times of nine; 4: own and edge ring plus five times own and vertex ring. What asks nobody has none.
GN_SHARED_CONST uint CANDIDATES_STEP = 5u;
GN_SHARED_CONST uint CANDIDATES_MOST = 50u; // of nine texels and vertex rings

// A pixel in a list: 16 bits of x, 16 of y, in image coordinates.
GN_SHARED_FN uint packPixel(uint x, uint y) { return x | (y << 16u); }
GN_SHARED_FN uint pixelX(uint packedPixel) { return packedPixel & 0xffffu; }
GN_SHARED_FN uint pixelY(uint packedPixel) { return packedPixel >> 16u; }

GN_SHARED_END
#endif
