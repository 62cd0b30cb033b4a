// Moments summed over all texels before one, and from that the mean over any box. 32-bit integers: a sum may go round
// any number of times, and a difference is exact all the same, as long as the box itself holds less than 2^32. Source:
// F. Crow, "Summed-area tables for texture mapping", SIGGRAPH 1984; integers: C. Peters et al., "Beyond hard shadows:
// moment shadow maps for single scattering, soft shadows and translucent occluders", I3D 2016.
#ifndef GNOMON_FILTERED_SUMMED_H
#define GNOMON_FILTERED_SUMMED_H
#include "moments.h"

GN_SHARED_BEGIN

// Widest box, texels: it may begin within one, so 2^12 texels, of less than 2^20 steps each.
GN_SHARED_CONST float MAX_SUMMED_BOX = 63.0f;
GN_SHARED_CONST float SUMMED_STEPS = 1048575.0f;
// Most texels per side of a table: the greatest value of the setting `resolution`.
GN_SHARED_CONST uint MAX_TABLE_SIDE = 2048u;

#define SUMMED_MEMBERS                                                                                                 \
    LinearDepth linear;                                                                                                \
    uint four;    /* 1: four moments (MSSM), 0: two (VSSM) */                                                          \
    float radius; /* of the light's disc: metres; directional: tangent of its angle */                                 \
    float bleeding;                                                                                                    \
    float momentBias;                                                                                                  \
    float texelsX; /* per metre across the map at linear depth 1; directional: anywhere */                             \
    float texelsY;                                                                                                     \
    float depthRange; /* metres of z = 1 */                                                                            \
    float deviation;  /* least, of z */

// std140.
struct SoftConstants {
    MapConstants base;
    SUMMED_MEMBERS
};
GN_SHARED_SIZE(SoftConstants, 464)

// Width of the box at depth t that blocks as much as the disc's cone from a receiver at depth z, metres at depth 1 (a
// directional light's: anywhere). sqrt(3): a box with the standard deviation of a disc of radius 1 along either axis.
GN_SHARED_FN float softWidth(float radius, bool positional, float depthRange, float z, float t)
{
    float between = max(z - t, 0.0f);
    float metres = radius * between * (positional ? 1.0f / max(z * t * depthRange, 1e-6f) : depthRange);
    return 1.7320508f * metres;
}

// Where the two edges of a box lie between entries of a table, along one axis.
struct SummedAxis {
    uint at[4];  // texels before these are summed
    vec3 weight; // of all but the first entry; with its own, which is not needed, they sum to 0
    float width;
};

GN_SHARED_FN SummedAxis summedAxis(float middle, float width, uint side)
{
    float last = float(side);
    float wide = clamp(width, 1.0f, min(MAX_SUMMED_BOX, last));
    float center = clamp(middle, 0.0f, last);
    float low = max(center - 0.5f * wide, 0.0f), high = min(center + 0.5f * wide, last);
    float lowBase = min(floor(low), last - 1.0f), highBase = min(floor(high), last - 1.0f);
    SummedAxis axis;
    axis.at[0] = uint(lowBase);
    axis.at[1] = uint(lowBase) + 1u;
    axis.at[2] = uint(highBase);
    axis.at[3] = uint(highBase) + 1u;
    float lowPart = low - lowBase, highPart = high - highBase;
    axis.weight = vec3(-lowPart, 1.0f - highPart, highPart);
    axis.width = high - low;
    return axis;
}

// hamburgerBefore() of two moments: what is not before the receiver taken to lie at its depth.
// Source: B. Yang et al., "Variance soft shadow mapping", Computer Graphics Forum 29, 2010.
GN_SHARED_FN vec2 chebyshevBefore(vec4 m, float leastVariance, float z)
{
    float lit = chebyshevLit(m.x, m.y, leastVariance, z);
    return vec2(1.0f - lit, m.x - lit * z);
}

GN_SHARED_END
#endif
