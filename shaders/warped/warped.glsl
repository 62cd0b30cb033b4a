// The warp of the map at hand. A map that no receiver was counted in has no functions: its texels stay where they are.
#ifdef RECTILINEAR
#include "rectilinear.glsl"
#else
#include "nonorthogonal.glsl"
#endif

// The texel for a place, 0..1.
uvec2 texelAt(uint map, vec2 at, float side)
{
    if (!isSeen(map, side)) return min(uvec2(at * side), uvec2(side - 1.0));
    return texelOf(map, at, side);
}

// The source place of a texel's middle, in texels.
vec2 texelPlace(uint map, uvec2 texel, float side)
{
    return isSeen(map, side) ? placeOf(map, texel, side) : vec2(texel) + 0.5;
}

// Bounds of a box of places, lower and upper corner.
vec4 texelBox(uint map, vec4 box, float side) { return isSeen(map, side) ? warpedBox(map, box, side) : box; }
