#version 460
// The pixels of a list (undecided.comp) as points of one pixel each, wherever they lie in the area drawn.
#extension GL_GOOGLE_include_directive : require
#include "ray_query.h"
#include "undecided.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RayQueryConstants constants;
};
layout(set = 0, binding = 6, std430) readonly buffer List {
    uvec4 command;
    uvec2 tiles[];
};

void main()
{
    uint place = min(uint(gl_VertexIndex) / LISTED_PIXELS, max(uint(tiles.length()), 1u) - 1u);
    uint number = uint(gl_VertexIndex) % LISTED_PIXELS;
    uvec2 tile = tiles[place];
    vec2 pixel = vec2(pixelX(tile.x) + number % LISTED_SIDE, pixelY(tile.x) + number / LISTED_SIDE);
    vec2 clip = 2.0 * (pixel + 0.5 - constants.area.xy) / constants.area.zw - 1.0;
    bool waits = (tile.y >> number & 1u) != 0u;
    gl_Position = vec4(waits ? clip : vec2(2.0), 0.0, 1.0); // outside of the clip volume: no point
    gl_PointSize = 1.0;
}
