#version 460
// One level of the pyramid of nearest and farthest depths, of one layer.
#extension GL_GOOGLE_include_directive : require
#include "depth_bounds.h"

layout(local_size_x = BOUNDS_GROUP, local_size_y = BOUNDS_GROUP) in;

layout(push_constant) uniform Push { DepthBoundsPush push; };
layout(std430, set = 0, binding = 0) buffer Bounds { vec2 bounds[]; };
layout(set = 0, binding = 1) uniform sampler2D map;

vec2 below(uvec2 at)
{
    if (push.fromMap != 0u) return vec2(texelFetch(map, ivec2(at), 0).x);
    return bounds[min(push.below + at.y * push.side + at.x, uint(bounds.length()) - 1u)];
}

void main()
{
    uvec2 square = gl_GlobalInvocationID.xy;
    uint side = boundsSide(push.side);
    if (square.x >= side || square.y >= side) return;
    vec2 range = vec2(1.0, 0.0);
    for (uint y = 0; y < BOUNDS_STEP; ++y) {
        for (uint x = 0; x < BOUNDS_STEP; ++x) {
            vec2 part = below(min(square * BOUNDS_STEP + uvec2(x, y), uvec2(push.side - 1u)));
            range = vec2(min(range.x, part.x), max(range.y, part.y));
        }
    }
    uint place = push.first + square.y * side + square.x;
    if (place < uint(bounds.length())) bounds[place] = range;
}
