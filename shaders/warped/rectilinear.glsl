// The warp of a rectilinear map: a function for x, one for y, and behind them the source place of every column and row.
#ifndef GNOMON_WARPED_RECTILINEAR_GLSL
#define GNOMON_WARPED_RECTILINEAR_GLSL
#include "table.glsl"

float warpedAxis(uint table, uint axis, float at)
{
    float edge = clamp(at, 0.0, 1.0) * float(WARP_BINS);
    uint before = min(uint(edge), WARP_BINS - 1u);
    uint first = table + axis * WARP_BIN_EDGES + before;
    return mix(tableAt(first), tableAt(first + 1u), edge - float(before));
}

// Places 0..1.
vec2 warped(uint map, vec2 at, float side)
{
    uint table = map * rectilinearTable(side);
    return vec2(warpedAxis(table, 0u, at.x), warpedAxis(table, 1u, at.y));
}

// The texel for a place, 0..1.
uvec2 texelOf(uint map, vec2 at, float side)
{
    return min(uvec2(warped(map, at, side) * side), uvec2(side - 1.0));
}

// Bounds of a box, lower and upper corner.
vec4 warpedBox(uint map, vec4 box, float side)
{
    return vec4(warped(map, box.xy, side), warped(map, box.zw, side));
}

uint functionCount(float side) { return 1u; }
uint firstPlace(uint map, float side) { return map * rectilinearTable(side) + RECTILINEAR_PLACES; }

#include "places.glsl"

// The source place of a texel's centre, in texels.
vec2 placeOf(uint map, uvec2 texel, float side)
{
    return vec2(placesOf(map, 0u, 0u, texel.x, side).x, placesOf(map, 1u, 0u, texel.y, side).x) * side;
}

// Whether any receiver is looked up in the map.
bool isSeen(uint map, float side) { return tableAt(map * rectilinearTable(side) + rectilinearSeen(side)) > 0.0; }
#endif
