#version 460
// The two functions of a rectilinear warp from importance per column and per row: a tent blurs it, a share is spread
// evenly, and running sums are the edges. A workgroup an axis of a
// map. Nothing important: every texel stays where it is.
//
// Where receivers of a column weigh m together, and its texels are w wide, m w is what is wrong there, and the sum over
// all columns is least where 1 / w goes with the root of m: `power` is 0.5. With 0 all that is seen is alike.
#extension GL_GOOGLE_include_directive : require
#include "warp.h"

const uint GROUP = 128u;
const uint EACH = WARP_BINS / GROUP;
layout(local_size_x = 128) in; // GROUP

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 1, std430) readonly buffer Importance { uint importance[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Tables { float tables[]; };

shared float raw[WARP_BINS];
shared float sums[2u * GROUP]; // read from one half, written to the other

float blurred(uint bin)
{
    uint radius = min(uint(max(warp.blur, 0.0)), MAX_BLUR_BINS);
    float sum = 0.0;
    for (uint i = 0u; i <= 2u * radius; ++i) { // bound: MAX_BLUR_BINS
        uint at = bin + i - radius;            // before 0 it is beyond the end
        float weight = float(radius + 1u) - abs(float(i) - float(radius));
        if (at < WARP_BINS) sum += weight * raw[at];
    }
    return sum;
}

void main()
{
    uint me = gl_LocalInvocationID.x, axis = gl_WorkGroupID.x, map = gl_WorkGroupID.z;
    if (axis > 1u || !hasWarpMap(warp, map)) return; // all of a workgroup
    uint size = rectilinearTable(warp.base.map.side), table = map * size, first = table + axis * WARP_BIN_EDGES;
    if (tables.length() < table + size) return;
    for (uint i = 0u; i < EACH; ++i) {
        uint bin = me * EACH + i;
        uint is = importance[(2u * map + axis) * WARP_BINS + bin];
        float value = warp.mostWeight == 0u ? uintBitsToFloat(is) : float(is);
        raw[bin] = value > 0.0 && value < 1e30 ? pow(value, clamp(warp.power, 0.0, 1.0)) : 0.0;
    }
    barrier();
    float own[EACH];
    float sum = 0.0;
    for (uint i = 0u; i < EACH; ++i) {
        own[i] = blurred(me * EACH + i);
        sum += own[i];
    }
    sums[me] = sum;
    barrier();
    uint from = 0u;
    for (uint step = 1u; step < GROUP; step += step) { // bound: GROUP
        uint before = min(step, GROUP);
        float total = sums[from + me] + (me >= before ? sums[from + me - before] : 0.0);
        from = GROUP - from;
        sums[from + me] = total;
        barrier();
    }
    float total = sums[from + GROUP - 1u];
    float even = clamp(warp.evenShare, 0.0, 1e3) * total / float(WARP_BINS);
    float all = total + even * float(WARP_BINS);
    float before = sums[from + me] - sum;
    for (uint i = 0u; i < EACH; ++i) {
        uint bin = me * EACH + i;
        float edge = all > 0.0 ? (before + even * float(bin)) / all : float(bin) / float(WARP_BINS);
        tables[first + bin] = clamp(edge, 0.0, 1.0);
        before += own[i];
    }
    if (me != 0u) return;
    tables[first + WARP_BINS] = 1.0;
    if (axis == 0u) tables[table + rectilinearSeen(warp.base.map.side)] = total > 0.0 ? 1.0 : 0.0;
}
