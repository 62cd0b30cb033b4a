#version 460
#extension GL_GOOGLE_include_directive : require
// The plane of every tile of the depth image, once per view.
#include "planar.h"
#include "../shared/tile_plane.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { PlaneChoice choice; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2, std430) writeonly buffer Tiles { TilePlane tiles[]; };

void main()
{
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= choice.grid.z) return;
    uvec2 first = PLANE_TILE * uvec2(tile % choice.grid.x, tile / choice.grid.x);
    tiles[tile] = tilePlane(depthImage, choice.view, ivec2(first) + ivec2(choice.middle.zw));
}
