// The mean over a box of a table of sums. The includer defines SUMMED_BEFORE(x, y, layer): the sum, a uvec4, of all
// texels of the layer before column x and row y.
#ifndef GNOMON_FILTERED_SUMMED_MEAN_H
#define GNOMON_FILTERED_SUMMED_MEAN_H
#include "summed.h"

GN_SHARED_BEGIN

// The box lies between texels. The weights of either axis sum to 0, so that the first entry of a row or column may be
// subtracted from all others. What is left are sums over at most the box and its rim, as integers.
GN_SHARED_FN vec4 boxMean(vec2 at, vec2 width, uint side, float layer)
{
    SummedAxis across = summedAxis(at.x, width.x, side), down = summedAxis(at.y, width.y, side);
    uvec4 left[4];
    for (int j = 0; j < 4; ++j)
        left[j] = SUMMED_BEFORE(across.at[0], down.at[j], layer);
    vec4 sum = vec4(0.0f);
    for (int i = 1; i < 4; ++i) {
        uvec4 top = SUMMED_BEFORE(across.at[i], down.at[0], layer);
        for (int j = 1; j < 4; ++j) {
            uvec4 part = SUMMED_BEFORE(across.at[i], down.at[j], layer) - left[j] - (top - left[0]);
            sum += across.weight[i - 1] * down.weight[j - 1] * vec4(part);
        }
    }
    return sum / (SUMMED_STEPS * across.width * down.width);
}

GN_SHARED_END
#endif
