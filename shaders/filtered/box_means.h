// Means over a box of odd width along one line, at a cost that does not depend on the width. The includer defines:
//   BOX_SOURCE(sums, at, line)        a texel of a line, a vec4
//   BOX_KEEP(sums, at, line, value)   notes a partial sum ...
//   BOX_KEPT(sums, at, line)          ... that this invocation reads again
//   BOX_STORE(sums, at, line, value)  the mean
//
// An invocation makes as many neighbouring means as the box has texels. The box of the k-th of them is what is left,
// from the k-th texel on, of the first box, and the k first texels behind that. Sums grow from both sides and nothing
// is subtracted: a running sum would leave of e^42 an error of e^26, which is more than all that a shadow holds.
// Source: M. van Herk, "A fast algorithm for local minimum and maximum filters on rectangular and octagonal kernels",
// Pattern Recognition Letters 13, 1992; here with sums.
#ifndef GNOMON_FILTERED_BOX_MEANS_H
#define GNOMON_FILTERED_BOX_MEANS_H
#include "moments.h"

GN_SHARED_BEGIN

// The texel at an offset that may lie outside: edges are repeated.
GN_SHARED_FN uint clampedTo(int at, uint side)
{
    return uint(clamp(at, 0, int(side) - 1));
}

GN_SHARED_FN void boxMeans(BoxSums sums, uint invocation)
{
    uint box = clamp(sums.box, 1u, MAX_MOMENT_FILTER);
    uint side = clamp(sums.side, 1u, 65535u);
    uint blocks = (side + box - 1u) / box;
    uint group = invocation / BOX_GROUP;
    uint line = group / blocks * BOX_GROUP + invocation % BOX_GROUP, first = group % blocks * box;
    if (line >= side) return;
    int begin = int(first) - int(box / 2u);
    float share = 1.0f / float(box);

    vec4 sum = vec4(0.0f);
    for (uint i = 0u; i < MAX_MOMENT_FILTER && i < box; ++i) {
        uint k = box - 1u - i;
        sum += share * BOX_SOURCE(sums, clampedTo(begin + int(k), side), line);
        if (first + k < side) BOX_KEEP(sums, first + k, line, sum);
    }
    sum = vec4(0.0f);
    for (uint k = 0u; k < MAX_MOMENT_FILTER && k < box; ++k) {
        if (first + k < side) BOX_STORE(sums, first + k, line, BOX_KEPT(sums, first + k, line) + sum);
        sum += share * BOX_SOURCE(sums, clampedTo(begin + int(box + k), side), line);
    }
}

GN_SHARED_END
#endif
