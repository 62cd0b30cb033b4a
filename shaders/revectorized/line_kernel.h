// Percentage-closer filtering of a map whose edges are lines (RPCF). Taps lie a texel apart, each at the receiver's place
// within its own texel, and each asks the ramp of revectorize.h. The ramp is what a texel's width makes of a line, so
// their mean is what a box makes of it. Source: Macedo 2018, 4.1.2, Algorithm 2.
//
// A stair is followed once: the next tap along it takes over both ends, a texel farther and a texel nearer. (The thesis
// takes it for the same one if an edge on any side is shared; here all along the way are, so the result is the same as
// without.) A tap at a straight edge, which has no ramp, compares the four texels around it instead: the bilinear tap of
// plain filtering. Where a stair turns at both ends, at tips and notches, the mean of both is nearest to the truth.
#ifndef GNOMON_REVECTORIZED_LINE_KERNEL_H
#define GNOMON_REVECTORIZED_LINE_KERNEL_H
#include "revectorize.h"

GN_SHARED_BEGIN

// Weights of taps: a disc, as far as `side` taps reach.
struct LineKernel {
    uint side;    // taps, odd
    float radius; // texels
    vec2 squeeze; // makes a disc of an ellipse: what is taken off an offset is its product with this vector, along it
};

GN_SHARED_FN LineKernel boxKernel(uint side)
{
    LineKernel kernel;
    kernel.side = side;
    kernel.radius = float(side); // reaches past the corners
    kernel.squeeze = vec2(0.0f, 0.0f);
    return kernel;
}

GN_SHARED_FN float tapWeight(LineKernel kernel, vec2 offset)
{
    vec2 onDisc = offset - kernel.squeeze * dot(kernel.squeeze, offset);
    return clamp(kernel.radius + 0.5f - length(onDisc), 0.0f, 1.0f);
}

// A row of texels, the first in bit 0.
struct TexelRow {
    uint lit;
    uint exists;
};

GN_SHARED_FN TexelRow texelRow(Tap tap, vec2 first, uint count)
{
    TexelRow row;
    row.lit = 0u;
    row.exists = 0u;
    for (uint x = 0u; x < MAX_LINE_TAPS + 2u && x < count; ++x) { // bound: MAX_LINE_TAPS
        vec2 centre = first + vec2(float(x), 0.0f);
        row.lit |= texelLit(tap, centre) ? 1u << x : 0u;
        row.exists |= texelExists(tap, centre) ? 1u << x : 0u;
    }
    return row;
}

// 1 if the texel says otherwise.
GN_SHARED_FN uint rowDiffers(TexelRow row, uint x, uint lit) { return (row.lit >> x ^ lit) & row.exists >> x & 1u; }

// EDGE_* of texel x of a row between two others.
GN_SHARED_FN uint rowEdges(TexelRow low, TexelRow own, TexelRow high, uint x)
{
    uint lit = own.lit >> x & 1u;
    return rowDiffers(own, x - 1u, lit) * EDGE_LOW_X | rowDiffers(own, x + 1u, lit) * EDGE_HIGH_X |
           rowDiffers(low, x, lit) * EDGE_LOW_Y | rowDiffers(high, x, lit) * EDGE_HIGH_Y;
}

GN_SHARED_FN float rowLit(uint lit, uint x) { return float(lit >> x & 1u); }

// Texel x of a row and its neighbours, weighted by how near they are.
GN_SHARED_FN float bilinearLit(TexelRow low, TexelRow own, TexelRow high, uint x, vec2 inTexel)
{
    vec2 part = abs(inTexel - 0.5f);
    uint beside = inTexel.x < 0.5f ? x - 1u : x + 1u, other = inTexel.y < 0.5f ? low.lit : high.lit;
    float here = rowLit(own.lit, x) + part.x * (rowLit(own.lit, beside) - rowLit(own.lit, x));
    float there = rowLit(other, x) + part.x * (rowLit(other, beside) - rowLit(other, x));
    return here + part.y * (there - here);
}

// A stair along one axis.
struct Run {
    uint key;    // its walls (bits 0 and 1: on the lower and the higher side), 4 where it is lit, 8; 0: not known
    uint closed; // bits 0 and 1: the low and the high end
    uint ways;   // and where it has to be followed on
    vec2 texels; // to both ends
};

// The stair that a tap is on, from that of the tap before it along the axis.
//   ends   bits 0 and 1: the texels before and after say otherwise
GN_SHARED_FN Run nextRun(Run before, uint key, uint ends, uint longest)
{
    Run run;
    run.key = key;
    run.closed = ends;
    run.ways = 0u;
    run.texels = vec2(0.0f, 0.0f);
    if ((key & 3u) == 0u) return run; // no wall goes along: it ends at its own texel
    if (before.key != key) {
        run.closed = 0u;
        run.ways = 3u;
        return run;
    }
    bool cut = before.texels.y >= float(longest);
    run.texels = before.texels + vec2(1.0f, -1.0f);
    bool far = run.texels.x >= float(longest);
    run.texels.x = min(run.texels.x, float(longest));
    run.closed = far ? before.closed & 2u : before.closed;
    run.ways = cut ? 2u : 0u;
    return run;
}

//   at       the receiver in the map, texels
//   longest  texels that a stair is followed to each side
GN_SHARED_FN float lineKernelVisibility(Tap tap, vec2 at, LineKernel kernel, uint longest)
{
    uint side = clamp(kernel.side, 1u, MAX_LINE_TAPS);
    longest = min(longest, MAX_STAIR);
    vec2 corner = floor(at), inTexel = at - corner;
    vec2 first = corner + (0.5f - 0.5f * float(side + 1u)); // with a texel around the kernel
    TexelRow rows[MAX_LINE_TAPS + 2u];
    uint some = 0u, every = ~0u;
    for (uint y = 0u; y < MAX_LINE_TAPS + 2u && y < side + 2u; ++y) { // bound: MAX_LINE_TAPS
        rows[y] = texelRow(tap, first + vec2(0.0f, float(y)), side + 2u);
        some |= rows[y].lit;
        every &= rows[y].lit;
    }
    if (some == 0u) return 0.0f;
    if (every == (1u << (side + 2u)) - 1u) return 1.0f;
    Run columns[MAX_LINE_TAPS];
    for (uint x = 0u; x < MAX_LINE_TAPS; ++x)
        columns[x].key = 0u;
    float sum = 0.0f, weights = 0.0f;
    for (uint y = 0u; y < MAX_LINE_TAPS && y < side; ++y) {
        TexelRow low = rows[y], own = rows[y + 1u], high = rows[y + 2u];
        Run row;
        row.key = 0u;
        for (uint x = 0u; x < MAX_LINE_TAPS && x < side; ++x) {
            vec2 centre = first + vec2(float(x) + 1.0f, float(y) + 1.0f);
            float weight = tapWeight(kernel, centre - corner - 0.5f);
            uint edges = weight > 0.0f ? rowEdges(low, own, high, x + 1u) : 0u;
            bool lit = (own.lit >> (x + 1u) & 1u) != 0u;
            float visibility = lit ? 1.0f : 0.0f;
            if (edges != 0u) {
                uint key = lit ? 12u : 8u;
                row = nextRun(row, key | edges >> 2, edges & 3u, longest);
                Run column = nextRun(columns[x], key | (edges & 3u), edges >> 2, longest);
                StairEnds ends;
                ends.texels = vec4(row.texels.x, row.texels.y, column.texels.x, column.texels.y);
                ends.closed = row.closed | column.closed << 2;
                ends = stairEnds(tap, centre, lit, edges, ends, row.ways | column.ways << 2, longest);
                row.texels = vec2(ends.texels.x, ends.texels.y);
                row.closed = ends.closed & 3u;
                column.texels = vec2(ends.texels.z, ends.texels.w);
                column.closed = ends.closed >> 2;
                column.key = row.closed == 0u && column.ways != 0u ? 0u : column.key; // not followed
                columns[x] = column;
                float place = stairPlaces(ends, inTexel, longest);
                float plain = bilinearLit(low, own, high, x + 1u, inTexel);
                float ramp = place < 0.0f ? plain : revectorizedAt(lit, place, REVECTORIZE_FILTERED);
                visibility = row.closed == 3u || column.closed == 3u ? 0.5f * (ramp + plain) : ramp;
            } else {
                row.key = 0u;
                columns[x].key = 0u;
            }
            sum += weight * visibility;
            weights += weight;
        }
    }
    return sum / weights;
}

GN_SHARED_END
#endif
