// The warp of a rectilinear map: a function for x, one for y, and behind them the source place of every column and row.
#ifndef GNOMON_WARPED_RECTILINEAR_GLSL
#define GNOMON_WARPED_RECTILINEAR_GLSL
#include "table.glsl"

float warpedAxis(uint axis, float at)
{
    float edge = clamp(at, 0.0, 1.0) * float(WARP_BINS);
    uint before = min(uint(edge), WARP_BINS - 1u);
    uint first = axis * WARP_BIN_EDGES + before;
    return mix(tableAt(first), tableAt(first + 1u), edge - float(before));
}

// Places 0..1.
vec2 warped(vec2 at) { return vec2(warpedAxis(0u, at.x), warpedAxis(1u, at.y)); }

// Bounds of a box, lower and upper corner.
vec4 warpedBox(vec4 box) { return vec4(warped(box.xy), warped(box.zw)); }

// The source place of a texel's centre, in texels.
vec2 placeOf(uvec2 texel, float side)
{
    uint first = 2u * WARP_BIN_EDGES;
    return vec2(tableAt(first + texel.x), tableAt(first + uint(side) + texel.y));
}
#endif
