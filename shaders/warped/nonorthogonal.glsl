// What triangles cover in a non-orthogonal map.
#ifndef GNOMON_WARPED_NONORTHOGONAL_GLSL
#define GNOMON_WARPED_NONORTHOGONAL_GLSL
#include "nonorthogonal_functions.glsl"

// What a stretch of a function can come to: where it begins by the least, where it ends by the greatest of all
// functions between two places across. Of the smallest blocks of which two next to each other hold these.
vec2 stretchAcross(WarpTable t, uint kind, vec2 across, vec2 stretch)
{
    Along begin = alongAt(t, stretch.x), end = alongAt(t, stretch.y);
    uint first = acrossAt(t, across.x).before, last = max(acrossAt(t, across.y).after, first);
    uint level = last - first < 2u ? 0u : uint(findMSB(last - first - 1u)) + 1u;
    if (level > 0u && (last >> (level - 1u)) - (first >> (level - 1u)) <= 1u) --level;
    uint least = functionsOf(t, kind), greatest = least;
    if (level > 0u) {
        least = t.first + t.bounds + (2u * kind * t.blocks + firstBlock(t, level)) * t.edges;
        greatest = least + t.blocks * t.edges;
    }
    uint a = (first >> level) * t.edges, b = (last >> level) * t.edges;
    return vec2(min(functionAt(least + a, begin), functionAt(least + b, begin)),
                max(functionAt(greatest + a, end), functionAt(greatest + b, end)));
}

// Bounds of a box, lower and upper corner. Places between two functions lie between theirs, so these hold.
vec4 warpedBox(uint map, vec4 box, float side)
{
    WarpTable t = warpTable(map, side);
    vec2 x = stretchAcross(t, 0u, box.yw, box.xz);
    vec2 y = stretchAcross(t, 1u, x, box.yw);
    return vec4(x.x, y.x, x.y, y.y);
}
#endif
