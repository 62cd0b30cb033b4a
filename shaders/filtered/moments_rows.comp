#version 460
// Depths of a map to moments, averaged along rows.
#extension GL_GOOGLE_include_directive : require
#include "moments.h"

layout(local_size_x = 64) in; // BOX_GROUP
layout(set = 0, binding = 0, std140) uniform Constants { BoxSums constants; };
layout(set = 0, binding = 1) uniform sampler2D map;
layout(set = 0, binding = 2, std430) buffer Means { float means[]; };
layout(constant_id = 0) const uint KIND = 0u;
const uint CHANNELS = KIND == MOMENTS_ESM ? 1u : (KIND == MOMENTS_EVSM4 || KIND == MOMENTS_MSM ? 4u : 2u);

#include "channels.glsl"

vec4 sourceAt(BoxSums sums, uint at, uint line)
{
    float depth = texelFetch(map, ivec2(at, line), 0).x;
    return momentsOf(KIND, sums.exponent, linearZ(sums.linear, depth));
}

void keep(BoxSums sums, uint at, uint line, vec4 value)
{
    uint texel = boxTexel(sums, at, line);
    STORE_TEXEL(means, texel, value)
}

vec4 kept(BoxSums sums, uint at, uint line)
{
    uint texel = boxTexel(sums, at, line);
    return LOAD_TEXEL(means, texel);
}

#define BOX_SOURCE sourceAt
#define BOX_KEEP keep
#define BOX_KEPT kept
#define BOX_STORE keep
#include "box_means.h"

uint groupOf() { return gl_WorkGroupID.x * gl_NumWorkGroups.y + gl_WorkGroupID.y; }

void main() { boxMeans(constants, groupOf() * 64u + gl_LocalInvocationID.x); }
