#version 460
// Sums of rows, summed along columns from the top: an invocation a column.
#extension GL_GOOGLE_include_directive : require
#include "summed.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std140) uniform Constants { BoxSums constants; };
layout(set = 0, binding = 1, std430) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 2, rgba32ui) uniform writeonly uimage2D table;

void main()
{
    uint x = gl_GlobalInvocationID.x;
    if (x >= constants.side) return;
    uvec4 sum = uvec4(0u);
    for (uint y = 0u; y < MAX_TABLE_SIDE && y < constants.side; ++y) {
        sum += sums[boxTexel(constants, y, x)];
        imageStore(table, ivec2(x, y), sum);
    }
}
