#version 460
// Revectorized visibility of places in maps that are pictures of shadows, 64 texels to a side and a bit a texel.
#extension GL_GOOGLE_include_directive : require

struct Tap {
    uint picture;
};
layout(std430, set = 0, binding = 1) readonly buffer Pictures { uint shadow[]; };
struct Place {
    vec2 at;
    uint picture;
    float longest;
    vec4 answers; // of the modes 0 to 2
};
layout(std430, set = 0, binding = 2) buffer Places { Place places[]; };
layout(local_size_x = 64) in;

bool texelExists(Tap tap, vec2 centre) { return min(centre.x, centre.y) > 0.0 && max(centre.x, centre.y) < 64.0; }

bool texelLit(Tap tap, vec2 centre)
{
    if (!texelExists(tap, centre)) return true;
    uint texel = 64u * uint(centre.y) + uint(centre.x);
    return (shadow[128u * tap.picture + texel / 32u] >> (texel % 32u) & 1u) == 0u;
}

#include "revectorized/revectorize.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= places.length()) return;
    Tap tap = Tap(places[i].picture);
    for (uint mode = 0u; mode < 3u; ++mode)
        places[i].answers[mode] = revectorizedVisibility(tap, places[i].at, mode, uint(places[i].longest));
}
