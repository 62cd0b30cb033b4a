#version 460
// Tiles with pixels that wait for their rays, listed behind the draw of their pixels as points. An invocation looks at one
// tile: what is near in the picture is near in the list, and rays that follow each other are alike.
#extension GL_GOOGLE_include_directive : require
#include "undecided.h"

layout(local_size_x = LISTED_GROUP, local_size_y = LISTED_GROUP) in;
layout(set = 0, binding = 0, std140) uniform Constants {
    UndecidedConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D statusImage;
layout(set = 0, binding = 4, std430) buffer List {
    uint points; // VkDrawIndirectCommand
    uint instances;
    uint firstPoint;
    uint firstInstance;
    uvec2 tiles[]; // first pixel, packed, and a bit for each that waits
};

// What Doubt::where of algorithms/hybrid/undecided.hpp says of a pixel.
bool isDoubted(uvec2 pixel)
{
    if (any(lessThan(pixel, constants.doubted.xy)) || any(greaterThanEqual(pixel, constants.doubted.zw))) return false;
    float depth = texelFetch(depthImage, ivec2(pixel), 0).x;
    if (depth == constants.view.skyDepth) return false;
    vec3 ray = receiverRayWs(constants.view, viewRayWs(constants.view, vec2(pixel) + 0.5), depth);
    vec3 receiverWs = constants.view.eyeWs.xyz + linearDepth(constants.view, depth) * ray;
    return clamp(receiverWs, constants.boxLowerWs.xyz, constants.boxUpperWs.xyz) == receiverWs;
}

bool waits(uvec2 pixel)
{
    uint status = uint(255.0 * texelFetch(statusImage, ivec2(pixel), 0).x + 0.5);
    return status == UNDECIDED || (status == constants.doubt.x && isDoubted(pixel));
}

void main()
{
    uvec2 first = LISTED_SIDE * gl_GlobalInvocationID.xy;
    uint waiting = 0u;
    for (uint i = 0u; i < LISTED_PIXELS; ++i) {
        uvec2 at = first + uvec2(i % LISTED_SIDE, i / LISTED_SIDE);
        if (all(lessThan(at, constants.pixels.zw)) && waits(constants.pixels.xy + at)) waiting |= 1u << i;
    }
    if (waiting == 0u) return;
    uint place = atomicAdd(points, LISTED_PIXELS) / LISTED_PIXELS;
    uvec2 pixel = constants.pixels.xy + first;
    if (place < uint(tiles.length())) tiles[place] = uvec2(packPixel(pixel.x, pixel.y), waiting);
}
