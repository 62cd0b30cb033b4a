#version 460
#extension GL_GOOGLE_include_directive : require
// STRIPS_A_TILE strips above each other become a tile, and all tiles the bounds of what the camera sees:
// once per view, whatever the lights.
#include "receiver_tile.h"

layout(local_size_x = 64) in; // STRIP_GROUP

layout(set = 0, binding = 0, std140) uniform Constants { uvec4 size; }; // tiles a row, rows of strips, tiles
layout(set = 0, binding = 1, std430) readonly buffer Strips { ReceiverTile strips[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Tiles { ReceiverTile tiles[]; };
layout(set = 0, binding = 3, std430) coherent buffer Bounds { ReceiverBounds bounds; };

// Reading first keeps most invocations off the atomics; an outdated value only makes one more of them try.
void widen(vec3 lower, vec3 upper)
{
    for (int axis = 0; axis < 3; ++axis) {
        uint low = orderedKey(lower[axis]), high = orderedKey(upper[axis]);
        if (low < bounds.lower[axis]) atomicMin(bounds.lower[axis], low);
        if (high > bounds.upper[axis]) atomicMax(bounds.upper[axis], high);
    }
}

void main()
{
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= size.z) return;
    uint row = tile / size.x, column = tile % size.x;
    uint first = row * STRIPS_A_TILE, last = min(first + STRIPS_A_TILE, size.y);
    ReceiverTile all = strips[first * size.x + column];
    for (uint i = first + 1; i < last; ++i) { // bound: STRIPS_A_TILE
        uint strip = i * size.x + column;
        all.lower = min(all.lower, vec4(strips[strip].lower.xyz, 1.0));
        all.lower.w = max(all.lower.w, strips[strip].lower.w);
        all.upper = max(all.upper, strips[strip].upper);
        all.normalLower = min(all.normalLower, strips[strip].normalLower);
        all.normalUpper = max(all.normalUpper, strips[strip].normalUpper);
    }
    tiles[tile] = all;
    if (all.lower.x <= all.upper.x) widen(all.lower.xyz, all.upper.xyz);
}
