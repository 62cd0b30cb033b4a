#version 460
// Smaller maps of filtered moments, all at once: a texel is the mean of the four below it, WORDS of 32 bits. An
// invocation makes four texels of level 1 and one of level 2, a group the rest of what covers 32 x 32 texels.
#extension GL_GOOGLE_include_directive : require
#include "moments.h"

layout(local_size_x = 8, local_size_y = 8) in; // MOMENT_LEVELS_TILE texels a group
layout(set = 0, binding = 0, std140) uniform Constants { BoxSums constants; };
layout(set = 0, binding = 1) uniform usampler2D moments;
#if WORDS == 1
layout(set = 0, binding = 2, r32ui) uniform writeonly uimage2D levels;
#elif WORDS == 2
layout(set = 0, binding = 2, rgba16ui) uniform writeonly uimage2D levels;
#else
layout(set = 0, binding = 2, rgba32ui) uniform writeonly uimage2D levels;
#endif

#include "moment_words.glsl"

shared vec4 means[64];

vec4 momentsAt(uvec2 texel)
{
    uvec4 words = texelFetch(moments, ivec2(min(texel, uvec2(constants.side - 1u))), 0);
#if WORDS == 2
    words = wordsOf(words);
#endif
    return unpackedMoments(constants.kind, constants.bits, words);
}

void store(uint level, uvec2 texel, vec4 value)
{
    if (max(texel.x, texel.y) >= constants.side >> level) return;
    uvec4 words = packedMoments(constants.kind, constants.bits, value);
#if WORDS == 2
    words = halvesOf(words);
#endif
    imageStore(levels, ivec2(momentLevelCorner(constants.side, level) + texel), words);
}

void main()
{
    uvec2 own = gl_LocalInvocationID.xy, tile = gl_WorkGroupID.xy * 8u + own;
    vec4 mean = vec4(0.0);
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 texel = 2u * tile + uvec2(i & 1u, i >> 1);
        vec4 four = 0.25 * momentsAt(2u * texel) + 0.25 * momentsAt(2u * texel + uvec2(1u, 0u)) +
                    0.25 * momentsAt(2u * texel + uvec2(0u, 1u)) + 0.25 * momentsAt(2u * texel + uvec2(1u));
        store(1u, texel, four);
        mean += 0.25 * four;
    }
    store(2u, tile, mean);
    uint at = own.y * 8u + own.x;
    for (uint level = 2u; level < MOMENT_LEVELS; ++level) {
        means[at] = mean;
        barrier();
        uint apart = 1u << (level - 2u);
        if (((own.x | own.y) & (2u * apart - 1u)) == 0u) {
            mean = 0.25 * (means[at] + means[at + apart] + means[at + 8u * apart] + means[at + 9u * apart]);
            store(level + 1u, tile >> (level - 1u), mean);
        }
        barrier();
    }
}
