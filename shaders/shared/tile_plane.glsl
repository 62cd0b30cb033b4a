// Finds the plane of a tile in the depth image.
#ifndef GNOMON_SHARED_TILE_PLANE_GLSL
#define GNOMON_SHARED_TILE_PLANE_GLSL
#include "tile_plane.h"

// Nine depths, seven pixels apart. A sphere of 1 000 pixels radius is off a plane by 2^-14 of its distance across that.
TilePlane tilePlane(sampler2D depthImage, ViewConstants view, ivec2 firstPixel)
{
    float q[9];
    bool sky = false;
    for (int i = 0; i < 9; ++i) {
        float depth = texelFetch(depthImage, firstPixel + ivec2(1 + 7 * (i % 3), 1 + 7 * (i / 3)), 0).x;
        sky = sky || depth == view.skyDepth;
        q[i] = 1.0 / linearDepth(view, depth);
    }
    TilePlane plane;
    plane.slopeX = (q[2] - q[0] + q[5] - q[3] + q[8] - q[6]) * (1.0 / 42.0);
    plane.slopeY = (q[6] - q[0] + q[7] - q[1] + q[8] - q[2]) * (1.0 / 42.0);
    float mean = (q[0] + q[1] + q[2] + q[3] + q[4] + q[5] + q[6] + q[7] + q[8]) / 9.0;
    float worst = 0.0;
    for (int i = 0; i < 9; ++i) {
        vec2 away = 7.0 * vec2(float(i % 3 - 1), float(i / 3 - 1));
        worst = max(worst, abs(q[i] - mean - away.x * plane.slopeX - away.y * plane.slopeY));
    }
    plane.inverse = mean;
    // Without a perspective linear depth tells nothing; what asks for planes does without there.
    plane.flatness = !sky && !isOrthographic(view) && worst <= mean / 16384.0 ? 1.0 : 0.0;
    return plane;
}
#endif
