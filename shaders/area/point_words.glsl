// What a pixel keeps of points. The includer declares `words`, a layer for 32 points: a bit of each, or with RAMPS four.
#ifndef GNOMON_AREA_POINT_WORDS_GLSL
#define GNOMON_AREA_POINT_WORDS_GLSL
#include "ramp_codes.glsl"

// As of ramp_codes.glsl.
uint pointCode(ivec2 pixel, uint place)
{
    uvec4 word = texelFetch(words, ivec3(pixel, place >> 5), 0);
#ifdef RAMPS
    return word[place >> 3 & 3u] >> 4u * (place & 7u) & RAMP_CODES;
#else
    return (word.x >> (place & 31u) & 1u) * RAMP_CODES;
#endif
}
#endif
