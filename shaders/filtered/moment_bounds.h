// Filtered statistics of depths, and what they say of a receiver. Depths are linear: 0 near to 1 far. GLSL, HLSL and
// C++.
#ifndef GNOMON_FILTERED_MOMENT_BOUNDS_H
#define GNOMON_FILTERED_MOMENT_BOUNDS_H
#include "../shared/types.h"

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

// From a map's depth to z: z = scale * d + offset, d the depth itself or, with a perspective, 1 / (1 - depth), which is
// the distance over that of the near end.
struct LinearDepth {
    float scale;
    float offset;
    float perspective; // 1 or 0
    float padding;
};

// Not cut at the map's ends.
GN_SHARED_FN float openZ(LinearDepth ends, float depth)
{
    // 2^-24 is half the distance of floats before 1: what lies so far is beyond every end.
    float d = ends.perspective != 0.0f ? 1.0f / max(1.0f - depth, 1.0f / 16777216.0f) : depth;
    return ends.scale * d + ends.offset;
}

GN_SHARED_FN float linearZ(LinearDepth ends, float depth)
{
    return clamp(openZ(ends, depth), 0.0f, 1.0f);
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
    if (!(first < z)) return vec2(0.0f, 0.0f);
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

// What rounding makes of moments of 32 bits. A variance is a difference of moments, and a deviation the root of what
// rounding makes of it: 2^-22 is four units of a float near 1. The bias: Peters and Klein 2015, 3.3.
GN_SHARED_CONST float MOMENT_DEVIATION = 1.0f / 2048.0f;
GN_SHARED_CONST float MOMENT_BIAS = 3e-7f;

struct MomentBounds {
    uint kind;
    float exponent;   // c, as momentExponent() has it
    float deviation;  // least standard deviation of z
    float momentBias; // MSM: share of the moments of 0 and 1, which keeps rounded ones possible
};

// Share of the filtered depths m at or beyond a receiver at z: of kinds with two or four moments the greatest possible.
// nearer: z less the standard deviation, over the box, of the receiver's own plane, which may be in the map. Mean
// depths of a plane are its depths, and means of a convex function are beyond them: there is no need for it. Of the
// concave one and of four moments a plane would otherwise shadow itself by a quarter.
GN_SHARED_FN float momentsLit(MomentBounds k, vec4 m, float z, float nearer)
{
    float c = k.exponent;
    float y = 2.0f * z - 1.0f;
    if (k.kind == MOMENTS_VSM) return chebyshevLit(m.x, m.y, k.deviation * k.deviation, z);
    if (k.kind == MOMENTS_MSM) {
        float share = k.momentBias;
        return hamburgerLit(m * (1.0f - share) + vec4(0.5f, 0.5f, 0.5f, 0.5f) * share, nearer);
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
