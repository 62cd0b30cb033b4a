#version 460
#extension GL_GOOGLE_include_directive : require
// Polygons of the listed cells: those triangles of their templates that are drawn, as indices behind a draw command.
#include "mccool.h"

layout(local_size_x = 64) in; // POLYGON_GROUP

layout(set = 0, binding = 0, std140) uniform Constants { PolygonConstants constants; };
layout(set = 0, binding = 1) uniform sampler2D map; // border: depth 1, past the map nothing casts
layout(set = 0, binding = 2, std430) readonly buffer Cells {
    uint cellCount;
    uint cells[];
};
layout(set = 0, binding = 3, std430) buffer Polygons {
    uint indexCount; // of the command
    uint instanceCount;
    uint command[3];
    uint asked; // indices, whether they fit or not
    uint padding[2];
    uint indices[];
};

float texelDepth(int x, int y)
{
    return textureLod(map, (vec2(x, y) + 0.5) / float(constants.surface.side), 0.0).x;
}

uint triangleAt(uint i) { return constants.templates[i >> 2][i & 3u]; }

void emit(int x, int y, uint jumps)
{
    vec4 depths = vec4(texelDepth(x, y), texelDepth(x + 1, y), texelDepth(x + 1, y + 1), texelDepth(x, y + 1));
    uint casters = uint(depths.x < NOTHING) | (uint(depths.y < NOTHING) << 1) | (uint(depths.z < NOTHING) << 2) |
                   (uint(depths.w < NOTHING) << 3);
    uint beyond = beyondJumps(jumps, depths);
    int last = int(constants.surface.side) - 1;
    bool rim = x < 0 || y < 0 || x == last || y == last;
    uint first = templateOf(jumps, depths) * TEMPLATE_TRIANGLES, count = 0u;
    uint end = first + min(triangleCountOf(jumps), TEMPLATE_TRIANGLES);
    for (uint i = first; i < end; ++i) // bound: TEMPLATE_TRIANGLES
        count += uint(isDrawn(triangleAt(i), beyond, casters, rim));
    uint place = atomicAdd(asked, 3u * count);
    bool fits = place + 3u * count <= constants.surface.indexCapacity;
    if (fits)
        atomicMax(indexCount, place + 3u * count);
    else
        instanceCount = 0u; // the count stays within the buffer all the same
    for (uint i = first; i < end && fits; ++i) { // bound: TEMPLATE_TRIANGLES
        uint triangle = triangleAt(i);
        if (!isDrawn(triangle, beyond, casters, rim)) continue;
        for (uint v = 0u; v < 3u; ++v)
            indices[place + v] = vertexIndex(constants.surface.side, x, y, vertexOf(triangle, v));
        place += 3u;
    }
}

void main()
{
    uint listed = min(cellCount, min(constants.surface.cellCapacity, uint(cells.length())));
    if (cellCount > listed) instanceCount = 0u;
    for (uint i = gl_GlobalInvocationID.x; i < listed; i += POLYGON_GROUPS * POLYGON_GROUP) // bound: cells
        emit(cellX(cells[i]), cellY(cells[i]), cells[i] >> 28);
}
