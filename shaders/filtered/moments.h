// How statistics of depths are filtered and kept.
#ifndef GNOMON_FILTERED_MOMENTS_H
#define GNOMON_FILTERED_MOMENTS_H
#include "../shared/map_lookup.h"
#include "moment_bounds.h"

GN_SHARED_BEGIN

// Most texels per side of the box: the greatest value of the setting `filter`.
GN_SHARED_CONST uint MAX_MOMENT_FILTER = 63u;

// std140.
struct MomentsConstants {
    MapConstants base;
    LinearDepth linear;
    uint kind;
    uint bits;        // 16 or 32
    float exponent;   // c, as momentExponent() has it
    float bleeding;   // [0, 1): what is darker counts as umbra
    float deviation;  // least standard deviation of z
    float momentBias; // MSM: share of the moments of 0 and 1, which keeps rounded ones possible
    float levels;      // smaller maps that may be looked up, 0 to MOMENT_LEVELS
    float planeTexels; // standard deviation of a place in the box along either axis
};
GN_SHARED_OFFSET(MomentsConstants, kind, 432)
GN_SHARED_SIZE(MomentsConstants, 464)

// Invocations of a group, which take neighbouring lines; the next group goes on along them, so that what two of them
// read is still in a cache.
GN_SHARED_CONST uint BOX_GROUP = 64u;

// A box filter along rows or columns. std140.
struct BoxSums {
    LinearDepth linear; // where depths are read
    float exponent;
    uint side;    // texels
    uint box;     // texels, odd
    uint columns; // 1: lines are columns, 0: rows
    uint kind;
    uint bits;
    uint padding0;
    uint padding1;
};
GN_SHARED_SIZE(BoxSums, 48)

// Buffers hold strips of so many columns one after another: what neighbouring invocations look at along a box lies in a
// few pages, whether the box goes along rows or columns. With whole rows a box of 31 would go through 31 pages.
GN_SHARED_CONST uint BOX_STRIP = 8u;

// Where a texel lies in buffers.
GN_SHARED_FN uint boxTexel(BoxSums sums, uint at, uint line)
{
    uint x = sums.columns != 0u ? line : at, y = sums.columns != 0u ? at : line;
    return (x / BOX_STRIP * sums.side + y) * BOX_STRIP + x % BOX_STRIP;
}

// Texels of a buffer.
GN_SHARED_FN uint boxTexels(uint side)
{
    return (side + BOX_STRIP - 1u) / BOX_STRIP * BOX_STRIP * side;
}

// Smaller maps of moments beside the map itself, level 0: of level n a texel is the mean of 4^n.
GN_SHARED_CONST uint MOMENT_LEVELS = 5u;
// Texels of level 0 per side that a work group makes all levels of.
GN_SHARED_CONST uint MOMENT_LEVELS_TILE = 32u;

// All levels lie in one image of these texels: level 1 on the left, the rest in a column beside it. A column of half the width
// would do for them; but where the sides of maps are powers of two, so are these.
GN_SHARED_FN uvec2 momentLevelsExtent(uint side)
{
    return uvec2(side, side >> 1);
}

// Where a level begins there. Level n has side >> n texels per side.
GN_SHARED_FN uvec2 momentLevelCorner(uint side, uint level)
{
    uint column = level > 1u ? side >> 1 : 0u;
    return uvec2(column, level > 1u ? column - (side >> (level - 1u)) : 0u);
}

// Channels of a kind.
GN_SHARED_FN uint momentChannels(uint kind)
{
    return kind == MOMENTS_ESM ? 1u : (kind == MOMENTS_EVSM4 || kind == MOMENTS_MSM ? 4u : 2u);
}

// The greatest exponent that a kind is computed with: squares, or the value itself, have to be finite numbers of the
// format with room for rounding: e^(2 * 42) = 3.0e36 of 3.4e38, e^(2 * 5.54) = 64800 of 65504.
GN_SHARED_FN float mostMomentExponent(uint kind, uint bits)
{
    float most = bits == 16u ? 5.54f : 42.0f;
    return kind == MOMENTS_ESM ? 2.0f * most : most;
}

GN_SHARED_FN float momentExponent(uint kind, uint bits, float asked)
{
    return clamp(asked, 1.0f, mostMomentExponent(kind, bits));
}

// Four moments of depths in [0, 1] as they are rounded to 16 bits each, and back. The mapping is linear, so that it
// commutes with filtering, and uses the range as evenly as it can.
// Source: Peters and Klein 2015, 3.2. The test `filtered_moments` multiplies the two.
GN_SHARED_FN vec4 toQuantised(vec4 m)
{
    return vec4(-2.07224649f * m.x + 32.23703778f * m.y - 68.571074599f * m.z + 39.3703274134f * m.w + 0.035955884801f,
                13.7948857237f * m.x - 59.4683975703f * m.y + 82.0359750338f * m.z - 35.364903257f * m.w,
                0.105877704f * m.x - 1.9077466311f * m.y + 9.3496555107f * m.z - 6.6543490743f * m.w,
                9.7924062118f * m.x - 33.7652110555f * m.y + 47.9456096605f * m.z - 23.9728048165f * m.w);
}

GN_SHARED_FN vec4 fromQuantised(vec4 q)
{
    float x = q.x - 0.035955884801f;
    return vec4(0.2227744146f * x + 0.0771972861f * q.y + 0.7926986636f * q.z + 0.0319417555f * q.w,
                0.1549679261f * x + 0.1394629426f * q.y + 0.7963415838f * q.z - 0.1722823173f * q.w,
                0.1451988946f * x + 0.2120202157f * q.y + 0.7258694464f * q.z - 0.2758014811f * q.w,
                0.163127443f * x + 0.2591432266f * q.y + 0.6539092497f * q.z - 0.3376131734f * q.w);
}

GN_SHARED_END
#endif
