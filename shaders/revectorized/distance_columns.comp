#version 460
// The nearest seed in the column of every pixel: an invocation a column, down and up again. Stored by columns, so that
// neighbours among the rows' invocations read neighbours.
#extension GL_GOOGLE_include_directive : require
#include "distance.h"

layout(local_size_x = 32) in; // DISTANCE_GROUP
layout(set = 0, binding = 0) uniform sampler2D seeds;
layout(set = 0, binding = 1, std430) buffer Sites { uint sites[]; };
layout(push_constant) uniform Push { DistanceRect rect; };

void main()
{
    uint x = gl_GlobalInvocationID.x;
    if (x >= rect.width) return;
    uint column = x * rect.height, last = NO_SITE;
    for (uint y = 0u; y < MAX_DISTANCE_SIDE && y < rect.height; ++y) {
        if (texelFetch(seeds, ivec2(rect.left + x, rect.top + y), 0).x > 0.0) last = x | y << 16;
        sites[column + y] = last;
    }
    last = NO_SITE;
    for (uint i = 0u; i < MAX_DISTANCE_SIDE && i < rect.height; ++i) {
        uint y = rect.height - 1u - i, above = sites[column + y];
        if (above != NO_SITE && (above >> 16) == y) last = above;
        bool below = last != NO_SITE && (above == NO_SITE || (last >> 16) - y < y - (above >> 16));
        if (below) sites[column + y] = last;
    }
}
