#version 460
#extension GL_GOOGLE_include_directive : require
// Cells of a depth map with a jump of depth on one of their sides, as a list. Every invocation walks down a column of
// cells, so that a row of texels is fetched once.
#include "mccool.h"

layout(local_size_x = 64) in; // EDGE_COLUMNS

layout(set = 0, binding = 0, std140) uniform Constants { DepthSurface surface; };
layout(set = 0, binding = 1) uniform sampler2D map; // border: depth 1, past the map nothing casts
layout(set = 0, binding = 2, std430) buffer Cells {
    uint cellCount;
    uint cells[];
};

// Texels x - 1 .. x + 2 of a row.
vec4 texelRow(int x, int y)
{
    float inverse = 1.0 / float(surface.side);
    vec2 at = (vec2(x, y) - vec2(0.5, -0.5)) * inverse;
    return vec4(textureLod(map, at, 0.0).x, textureLod(map, at + vec2(inverse, 0.0), 0.0).x,
                textureLod(map, at + vec2(2.0 * inverse, 0.0), 0.0).x,
                textureLod(map, at + vec2(3.0 * inverse, 0.0), 0.0).x);
}

void main()
{
    int side = int(surface.side);
    int x = int(gl_GlobalInvocationID.x) - 1; // of the left texel; the first and the last lie outside the map
    if (x >= side) return;
    int firstRow = int(gl_WorkGroupID.y * EDGE_ROWS) - 1, lastRow = min(firstRow + int(EDGE_ROWS), side);
    vec4 above = texelRow(x, firstRow - 1), upper = texelRow(x, firstRow), lower = texelRow(x, firstRow + 1);
    bool top = depthJumps(surface, upper.x, upper.y, upper.z, upper.w);
    for (int y = firstRow; y < lastRow; ++y) { // bound: EDGE_ROWS
        vec4 below = texelRow(x, y + 2);
        bool bottom = depthJumps(surface, lower.x, lower.y, lower.z, lower.w);
        bool left = depthJumps(surface, above.y, upper.y, lower.y, below.y);
        bool right = depthJumps(surface, above.z, upper.z, lower.z, below.z);
        uint jumps = uint(top) | (uint(right) << 1) | (uint(bottom) << 2) | (uint(left) << 3);
        if (jumps != 0u) {
            uint place = atomicAdd(cellCount, 1u);
            if (place < surface.cellCapacity) cells[place] = packCell(x, y, jumps);
        }
        above = upper;
        upper = lower;
        lower = below;
        top = bottom;
    }
}
