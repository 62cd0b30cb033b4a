// Moments as they are kept: channels of 16 or 32 bits in one, two or four words. Of two words each half is a channel of
// a 16-bit format, since no device need write images of two 32-bit channels.
#ifndef GNOMON_FILTERED_MOMENT_WORDS_GLSL
#define GNOMON_FILTERED_MOMENT_WORDS_GLSL
#include "moments.h"

// VSM's and MSM's 16 bits are fractions, those of exponentials half floats.
uvec4 packedMoments(uint kind, uint bits, vec4 m)
{
    if (bits != 16u) return floatBitsToUint(m);
    if (kind == MOMENTS_VSM) return uvec4(packUnorm2x16(m.xy), 0u, 0u, 0u);
    if (kind == MOMENTS_MSM) {
        vec4 q = toQuantised(m);
        return uvec4(packUnorm2x16(q.xy), packUnorm2x16(q.zw), 0u, 0u);
    }
    return uvec4(packHalf2x16(m.xy), packHalf2x16(m.zw), 0u, 0u);
}

vec4 unpackedMoments(uint kind, uint bits, uvec4 words)
{
    if (bits != 16u) return uintBitsToFloat(words);
    if (kind == MOMENTS_VSM) return vec4(unpackUnorm2x16(words.x), 0.0, 0.0);
    if (kind == MOMENTS_MSM) return fromQuantised(vec4(unpackUnorm2x16(words.x), unpackUnorm2x16(words.y)));
    return vec4(unpackHalf2x16(words.x), unpackHalf2x16(words.y));
}

uvec4 halvesOf(uvec4 words) { return uvec4(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu, words.y >> 16); }
uvec4 wordsOf(uvec4 halves) { return uvec4(halves.x | halves.y << 16, halves.z | halves.w << 16, 0u, 0u); }
#endif
