#version 460
// Quads of the view's tiles, six vertices each, but for those where there is nothing to draw; the view ray is linear on
// the screen.
#extension GL_GOOGLE_include_directive : require
#include "resolve.h"

layout(constant_id = 0) const uint PART = RESOLVE_DARK; // of resolve.frag

layout(set = 0, binding = 0, std140) uniform Constants { VolumeResolve resolve; };
layout(set = 0, binding = 3, std430) readonly buffer Tiles { ReceiverTile tiles[]; };
layout(location = 0) noperspective out vec3 rayWs;

void main()
{
    uint tile = uint(gl_VertexIndex) / 6u, corner = uint(gl_VertexIndex) % 6u; // of a quad: 0 1 2, 2 1 3
    corner = corner < 3u ? corner : corner == 3u ? 2u : corner == 4u ? 1u : 3u;
    uvec2 place = uvec2(tile % resolve.tileColumns, tile / resolve.tileColumns) + uvec2(corner & 1u, corner >> 1);
    vec2 first = vec2(uint(resolve.area.x) / FOUR * FOUR, resolve.area.y);
    vec2 pixel = first + vec2(place * uvec2(TILE_COLUMNS, TILE_ROWS));
    pixel = clamp(pixel, resolve.area.xy, resolve.area.xy + resolve.area.zw);
    rayWs = viewRayWs(resolve.view, pixel);
    gl_Position = vec4((pixel - resolve.area.xy) / resolve.area.zw * 2.0 - 1.0, 0.0, 1.0);
    // Nothing: all corners at one point.
    if (!partCovers(PART, tileAnswer(tiles[tile], resolve), resolve)) gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
