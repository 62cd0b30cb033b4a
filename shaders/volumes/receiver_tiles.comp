#version 460
#extension GL_GOOGLE_include_directive : require
// The boxes of TILE_COLUMNS strips beside each other become the box of a tile: once per view, whatever the lights.
#include "cull.h"

layout(local_size_x = 64) in; // CULL_GROUP

layout(set = 0, binding = 0, std140) uniform Constants { uvec4 size; }; // strips and tiles a row, tiles
layout(set = 0, binding = 1, std430) readonly buffer Strips { ReceiverBox strips[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Tiles { ReceiverBox tiles[]; };

void main()
{
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= size.z) return;
    uint row = tile / size.y, first = (tile % size.y) * TILE_COLUMNS;
    uint last = min(first + TILE_COLUMNS, size.x);
    vec3 lower = vec3(1e38), upper = vec3(-1e38);
    for (uint strip = row * size.x + first; strip < row * size.x + last; ++strip) {
        lower = min(lower, strips[strip].lower.xyz);
        upper = max(upper, strips[strip].upper.xyz);
    }
    tiles[tile] = ReceiverBox(vec4(lower, 0.0), vec4(upper, 0.0));
}
