#version 460
// Moments of a map's depths, summed along rows from the left: an invocation a row.
#extension GL_GOOGLE_include_directive : require
#include "summed.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std140) uniform Constants { BoxSums constants; };
layout(set = 0, binding = 1) uniform sampler2D map;
layout(set = 0, binding = 2, std430) writeonly buffer Sums { uvec4 sums[]; };

void main()
{
    uint y = gl_GlobalInvocationID.x;
    if (y >= constants.side) return;
    uvec4 sum = uvec4(0u);
    for (uint x = 0u; x < MAX_TABLE_SIDE && x < constants.side; ++x) {
        float z = linearZ(constants.linear, texelFetch(map, ivec2(x, y), 0).x);
        sum += uvec4(momentsOf(MOMENTS_MSM, 1.0, z) * SUMMED_STEPS + 0.5);
        sums[boxTexel(constants, x, y)] = sum;
    }
}
