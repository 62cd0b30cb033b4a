#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/tile_plane.glsl"

// Nearest and farthest distance along the view (linear depth) of every 16x16 tile, and its plane if it shows one: what the facts need to know about
// receivers. One invocation a tile, four depths a gather. Sky counts for nothing.
layout(local_size_x = 8, local_size_y = 8) in;

struct DepthTile {
    float nearest;
    float farthest;
    TilePlane plane;
};

layout(std140, set = 0, binding = 0) uniform Constants {
    ViewConstants view;
    uvec4 grid; // tiles in x and y, first pixel in x and y
    uvec4 size; // pixels drawn in x and y
};
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(std430, set = 0, binding = 2) writeonly buffer Tiles { DepthTile tiles[]; };

const uint TILE = PLANE_TILE;

// The plane through the middle of a tile that shows more than one; inverse 0: sky. Of the pixels to either side the
// closer one is of the same surface.
TilePlane middlePlane(ivec2 firstPixel)
{
    ivec2 middle = firstPixel + ivec2(PLANE_TILE_MIDDLE);
    float q[5];
    for (int i = 0; i < 5; ++i) {
        ivec2 away = i == 0 ? ivec2(0) : i < 3 ? ivec2(2 * i - 3, 0) : ivec2(0, 2 * i - 7);
        float depth = texelFetch(depthImage, middle + away, 0).x;
        q[i] = depth == view.skyDepth ? 0.0 : 1.0 / linearDepth(view, depth);
    }
    float left = q[0] - q[1], right = q[2] - q[0], up = q[0] - q[3], down = q[4] - q[0];
    return TilePlane(q[0], abs(left) < abs(right) ? left : right, abs(up) < abs(down) ? up : down, 0.0);
}

void main()
{
    uvec2 tile = gl_GlobalInvocationID.xy;
    if (tile.x >= grid.x || tile.y >= grid.y) return;
    vec2 texel = 1.0 / vec2(textureSize(depthImage, 0));
    float nearest = 3.0e38, farthest = -3.0e38;
    for (uint y = 0; y < TILE; y += 2)
        for (uint x = 0; x < TILE; x += 2) {
            uvec2 inside = min(tile * TILE + uvec2(x, y), max(size.xy, uvec2(2)) - 2);
            vec4 depths = textureGather(depthImage, (vec2(inside + grid.zw) + 1.0) * texel);
            for (int i = 0; i < 4; ++i) {
                if (depths[i] == view.skyDepth) continue;
                float distance = viewDistance(view, depths[i]);
                nearest = min(nearest, distance);
                farthest = max(farthest, distance);
            }
        }
    TilePlane plane = TilePlane(0.0, 0.0, 0.0, 0.0);
    uvec2 first = tile * TILE;
    if (first.x + TILE <= size.x && first.y + TILE <= size.y)
        plane = tilePlane(depthImage, view, ivec2(first + grid.zw));
    if (first.x + TILE <= size.x && first.y + TILE <= size.y && plane.flatness == 0.0 && !isOrthographic(view))
        plane = middlePlane(ivec2(first + grid.zw));
    tiles[tile.y * grid.x + tile.x] = DepthTile(nearest, farthest, plane);
}
