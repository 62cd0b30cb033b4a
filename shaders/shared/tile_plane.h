// The plane that a tile of the depth image shows, if it shows one: what the facts and the methods that need a flat
// receiver know about it. In the screen a plane's inverse depth is linear: 1 / w = inverse + slope . (pixels away).
#ifndef GNOMON_SHARED_TILE_PLANE_H
#define GNOMON_SHARED_TILE_PLANE_H
#include "receiver.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint PLANE_TILE = 16u;          // pixels a side
GN_SHARED_CONST float PLANE_TILE_MIDDLE = 8.5f; // where TilePlane::inverse is, pixels from the tile's corner

struct TilePlane {
    float inverse;  // 1 / linear depth at the centre of its ninth pixel in x and y, 1 / metres
    float slopeX;   // its change per pixel to the right
    float slopeY;   // and per pixel down
    float flatness; // 1: the tile shows one plane; 0: it does not, or sky
};
GN_SHARED_SIZE(TilePlane, 16)

// Of a plane given in the middle of another tile, there.
GN_SHARED_FN float planeInverse(TilePlane plane, vec2 away)
{
    return plane.inverse + away.x * plane.slopeX + away.y * plane.slopeY;
}

// How far off a tile may be and still show the plane. `loose`: against the plane of a single tile, whose slopes are
// known to 2^-22 of its inverse depth across 14 pixels, thus to 2^-16 of it across a screen of a thousand, four times
// that allowed; and to 2^-9 of the tile's own. Otherwise: 2^-17 and 2^-13, against a plane fitted to many tiles.
GN_SHARED_FN float planeTolerance(float tileInverse, float knownInverse, bool loose)
{
    float known = max(knownInverse, 0.0f); // below 0: the middle lies beyond the plane's horizon
    return loose ? tileInverse / 512.0f + known / 16384.0f : tileInverse / 8192.0f + known / 131072.0f;
}

// Whether the tile, `away` pixels from the plane's own middle, shows the same plane.
GN_SHARED_FN bool showsPlane(TilePlane tile, TilePlane plane, vec2 away, bool loose)
{
    float tolerance = planeTolerance(tile.inverse, plane.inverse, loose);
    // Slopes across the tile: what crosses the plane in the tile's middle has others. Known to one tile only.
    float slopes = max(abs(tile.slopeX - plane.slopeX), abs(tile.slopeY - plane.slopeY));
    float slopeTolerance = planeTolerance(tile.inverse, plane.inverse, true);
    return tile.flatness > 0.0f && abs(tile.inverse - planeInverse(plane, away)) <= tolerance &&
           slopes * 16.0f <= slopeTolerance;
}

// The normal n of a plane from its inverse depth on the screen, with dot(n, p) = 1 on it for p relative to the eye: that is
// inverse depth = dot(n, view ray), and view rays are linear.
GN_SHARED_FN vec3 planeNormal(vec3 middleRay, vec3 rayDx, vec3 rayDy, float inverseDepth, float slopeX, float slopeY)
{
    vec3 dxDy = cross(rayDx, rayDy);
    vec3 sum = dxDy * inverseDepth + cross(rayDy, middleRay) * slopeX + cross(middleRay, rayDx) * slopeY;
    return sum / dot(middleRay, dxDy);
}

GN_SHARED_END
#endif
