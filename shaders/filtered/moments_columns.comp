#version 460
// Moments averaged along columns, as they are kept: WORDS of 32 bits a texel.
#extension GL_GOOGLE_include_directive : require
#include "moments.h"

layout(local_size_x = 64) in; // BOX_GROUP
layout(set = 0, binding = 0, std140) uniform Constants { BoxSums constants; };
layout(set = 0, binding = 1, std430) readonly buffer Source { float source[]; };
layout(set = 0, binding = 2, std430) buffer Partial { float partial[]; };
#if WORDS == 1
layout(set = 0, binding = 3, r32ui) uniform writeonly uimage2D moments;
#elif WORDS == 2
layout(set = 0, binding = 3, rgba16ui) uniform writeonly uimage2D moments;
#else
layout(set = 0, binding = 3, rgba32ui) uniform writeonly uimage2D moments;
#endif
layout(constant_id = 0) const uint CHANNELS = 4u;

#include "channels.glsl"
#include "moment_words.glsl"

vec4 sourceAt(BoxSums sums, uint at, uint line)
{
    uint texel = boxTexel(sums, at, line);
    return LOAD_TEXEL(source, texel);
}

void keep(BoxSums sums, uint at, uint line, vec4 value)
{
    uint texel = boxTexel(sums, at, line);
    STORE_TEXEL(partial, texel, value)
}

vec4 kept(BoxSums sums, uint at, uint line)
{
    uint texel = boxTexel(sums, at, line);
    return LOAD_TEXEL(partial, texel);
}

void store(BoxSums sums, uint at, uint line, vec4 value)
{
    uvec4 words = packedMoments(constants.kind, constants.bits, value);
#if WORDS == 2
    words = halvesOf(words);
#endif
    imageStore(moments, ivec2(line, at), words);
}

#define BOX_SOURCE sourceAt
#define BOX_KEEP keep
#define BOX_KEPT kept
#define BOX_STORE store
#include "box_means.h"

uint groupOf() { return gl_WorkGroupID.x * gl_NumWorkGroups.y + gl_WorkGroupID.y; }

void main() { boxMeans(constants, groupOf() * 64u + gl_LocalInvocationID.x); }
