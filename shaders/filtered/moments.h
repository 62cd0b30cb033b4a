// Filtered statistics of depths, and what they say of a receiver. Depths are linear: 0 near to 1 far.
#ifndef GNOMON_FILTERED_MOMENTS_H
#define GNOMON_FILTERED_MOMENTS_H
#include "../shared/map_lookup.h"

#ifdef __cplusplus
GN_SHARED_BEGIN
using glm::exp;
GN_SHARED_END
#endif

GN_SHARED_BEGIN

// What is kept of a depth z, with y = 2 z - 1 and c the exponent.
GN_SHARED_CONST uint MOMENTS_VSM = 0u;   // z, z^2: W. Donnelly and A. Lauritzen, "Variance shadow maps", I3D 2006
GN_SHARED_CONST uint MOMENTS_ESM = 1u;   // e^(c y): T. Annen et al., "Exponential shadow maps", GI 2008
GN_SHARED_CONST uint MOMENTS_EVSM2 = 2u; // e^(c y) and its square: A. Lauritzen, "Rendering antialiased shadows using
                                         // warped variance shadow maps", thesis, Waterloo 2008
GN_SHARED_CONST uint MOMENTS_EVSM4 = 3u; // the same, and of -e^(-c y)
GN_SHARED_CONST uint MOMENTS_MSM = 4u;   // z to z^4: C. Peters and R. Klein, "Moment shadow mapping", I3D 2015
GN_SHARED_CONST uint MOMENT_KINDS = 5u;

// Most texels per side of the box: the greatest value of the setting `filter`.
GN_SHARED_CONST uint MAX_MOMENT_FILTER = 63u;

// From a map's depth to z: z = scale * d + offset, d the depth itself or, with a perspective, 1 / (1 - depth), which is
// the distance over that of the near end.
struct LinearDepth {
    float scale;
    float offset;
    float perspective; // 1 or 0
    float padding;
};

// Not cut at the map's ends.
GN_SHARED_FN float openZ(LinearDepth linear, float depth)
{
    // 2^-24 is half the distance of floats before 1: what lies so far is beyond every end.
    float d = linear.perspective != 0.0f ? 1.0f / max(1.0f - depth, 1.0f / 16777216.0f) : depth;
    return linear.scale * d + linear.offset;
}

GN_SHARED_FN float linearZ(LinearDepth linear, float depth)
{
    return clamp(openZ(linear, depth), 0.0f, 1.0f);
}

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
    float padding0;
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

// Channels of a kind.
GN_SHARED_FN uint momentChannels(uint kind)
{
    return kind == MOMENTS_ESM ? 1u : (kind == MOMENTS_EVSM4 || kind == MOMENTS_MSM ? 4u : 2u);
}

// The exponent that a kind is computed with: squares, or the value itself, have to be finite numbers of the format with
// room for rounding: e^(2 * 42) = 3.0e36 of 3.4e38, e^(2 * 5.54) = 64800 of 65504.
GN_SHARED_FN float momentExponent(uint kind, uint bits, float asked)
{
    float most = bits == 16u ? 5.54f : 42.0f;
    return clamp(asked, 1.0f, kind == MOMENTS_ESM ? 2.0f * most : most);
}

GN_SHARED_FN vec4 momentsOf(uint kind, float exponent, float z)
{
    float square = z * z;
    if (kind == MOMENTS_VSM) return vec4(z, square, 0.0f, 0.0f);
    if (kind == MOMENTS_MSM) return vec4(z, square, square * z, square * square);
    float more = exp(exponent * (2.0f * z - 1.0f));
    if (kind == MOMENTS_ESM) return vec4(more, 0.0f, 0.0f, 0.0f);
    float less = kind == MOMENTS_EVSM4 ? -exp(-exponent * (2.0f * z - 1.0f)) : 0.0f;
    return vec4(more, more * more, less, less * less);
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

// Greatest share of depths at or beyond z that have this mean and square: one-tailed Chebyshev inequality.
// leastVariance: what rounding leaves of a variance of 0.
GN_SHARED_FN float chebyshevLit(float mean, float square, float leastVariance, float z)
{
    float variance = max(square - mean * mean, leastVariance);
    float beyond = max(z - mean, 0.0f);
    return variance / (variance + beyond * beyond);
}

// What lies before a receiver at z, of four moments: its share, and the share times its mean depth. Hamburger's
// problem: of all distributions with the moments m one of three depths, one of them z, has the least share before z.
// The weights are by Vandermonde's system, the other two depths by a quadratic, whose coefficients solve the Hankel
// matrix of the moments (Cholesky). Source: Peters and Klein 2015, algorithm 3; the mean: C. Peters et al., "Beyond
// hard shadows", I3D 2016.
GN_SHARED_FN vec2 hamburgerBefore(vec4 m, float z)
{
    float variance = max(m.y - m.x * m.x, 1e-12f);
    float l = (m.z - m.x * m.y) / variance;
    float rest = max(m.w - m.y * m.y - l * (m.z - m.x * m.y), 1e-12f);
    // c solves Hankel c = (1, z, z^2); depths are the roots of c.x + c.y t + c.z t^2.
    float c1 = z - m.x;
    float c2 = (z * z - m.y - l * c1) / rest;
    c1 = c1 / variance - l * c2;
    float c0 = 1.0f - c1 * m.x - c2 * m.y;
    // Where c2 vanishes one root is infinite and has no weight; a small number instead does the same.
    c2 = abs(c2) < 1e-20f ? 1e-20f : c2;
    float p = c1 / c2, q = c0 / c2;
    float r = sqrt(max(0.25f * p * p - q, 0.0f));
    float first = -0.5f * p - r, second = -0.5f * p + r;
    if (second < z) { // both are before: all but the weight of z
        float own = (first * second - m.x * (first + second) + m.y) / ((z - first) * (z - second));
        return vec2(1.0f - own, m.x - own * z);
    }
    if (!(first < z)) return vec2(0.0f);
    float share = (z * second - m.x * (z + second) + m.y) / ((second - first) * (z - first));
    return vec2(share, share * first);
}

GN_SHARED_FN float hamburgerLit(vec4 m, float z)
{
    float before = hamburgerBefore(m, z).x;
    // Compared so that what is no number is lit.
    return before > 0.0f ? max(1.0f - before, 0.0f) : 1.0f;
}

// What is below `bleeding` counts as umbra (Lauritzen, "Summed-area variance shadow maps", GPU Gems 3, 8.4.3).
GN_SHARED_FN float withoutBleeding(float lit, float bleeding)
{
    return clamp((lit - bleeding) / (1.0f - bleeding), 0.0f, 1.0f);
}

// Share of the filtered depths m at or beyond a receiver at z: of kinds with two or four moments the greatest possible.
// nearer: z less the standard deviation, over the box, of the receiver's own plane, which may be in the map. Mean
// depths of a plane are its depths, and means of a convex function are beyond them: there is no need for it. Of the
// concave one and of four moments a plane would otherwise shadow itself by a quarter.
GN_SHARED_FN float momentsLit(MomentsConstants k, vec4 m, float z, float nearer)
{
    float c = k.exponent;
    float y = 2.0f * z - 1.0f;
    if (k.kind == MOMENTS_VSM) return chebyshevLit(m.x, m.y, k.deviation * k.deviation, z);
    if (k.kind == MOMENTS_MSM) {
        float share = k.momentBias;
        return hamburgerLit(m * (1.0f - share) + vec4(0.5f * share), nearer);
    }
    float warped = exp(c * y);
    if (k.kind == MOMENTS_ESM) return clamp(m.x / warped, 0.0f, 1.0f);
    // The deviation of a warped depth: its slope times that of y.
    float slope = 2.0f * k.deviation * c;
    float lit = chebyshevLit(m.x, m.y, slope * warped * slope * warped, warped);
    if (k.kind == MOMENTS_EVSM2) return lit;
    float other = exp(-c * (2.0f * nearer - 1.0f));
    return min(lit, chebyshevLit(m.z, m.w, slope * other * slope * other, -other));
}

GN_SHARED_END
#endif
