// The warp of a non-orthogonal map for those that draw it and look it up.
#ifndef GNOMON_WARPED_NONORTHOGONAL_GLSL
#define GNOMON_WARPED_NONORTHOGONAL_GLSL
#include "nonorthogonal_functions.glsl"

layout(set = 0, binding = 6) uniform sampler2DArray places;

// What a stretch of a function can come to: where it begins by the least, where it ends by the greatest of all
// functions between two places across.
vec2 stretchAcross(uint map, uint kind, vec2 across, vec2 stretch)
{
    Along begin = alongAt(stretch.x), end = alongAt(stretch.y);
    uint first = acrossAt(across.x).before, last = acrossAt(across.y).after;
    vec2 result = vec2(1.0, 0.0);
    if (last - first < WARP_BLOCK) {
        for (uint i = 0u; i < WARP_BLOCK; ++i) {
            uint from = functionsOf(map, kind) + min(first + i, last) * WARP_CELL_EDGES;
            result = vec2(min(result.x, functionAt(from, begin)), max(result.y, functionAt(from, end)));
            if (first + i >= last) break;
        }
        return result;
    }
    uint lastBlock = last / WARP_BLOCK;
    for (uint i = 0u; i < WARP_BLOCKS; ++i) {
        uint block = min(first / WARP_BLOCK + i, lastBlock);
        uint from = map * WARP_TABLE + 2u * WARP_FUNCTIONS + 2u * (kind * WARP_BLOCKS + block) * WARP_CELL_EDGES;
        float least = mix(tableAt(from + 2u * begin.edge), tableAt(from + 2u * begin.edge + 2u), begin.share);
        float greatest = mix(tableAt(from + 2u * end.edge + 1u), tableAt(from + 2u * end.edge + 3u), end.share);
        result = vec2(min(result.x, least), max(result.y, greatest));
        if (block >= lastBlock) break;
    }
    return result;
}

// Bounds of a box, lower and upper corner.
vec4 warpedBox(uint map, vec4 box, float side)
{
    vec2 x = stretchAcross(map, 0u, box.yw, box.xz);
    vec2 y = stretchAcross(map, 1u, x, box.yw);
    return vec4(x.x, y.x, x.y, y.y);
}

// The source place of a texel's centre, in texels.
vec2 placeOf(uint map, uvec2 texel, float side) { return texelFetch(places, ivec3(texel, map), 0).xy; }

// Whether any receiver is looked up in the map.
bool isSeen(uint map, float side) { return tableAt(map * WARP_TABLE + WARP_SEEN) > 0.0; }
#endif
