// What a view's receivers are to volumes: depths that counts are asked for at, and tiles of pixels of which it is known
// where their surfaces lie and how they are turned.
//
// Positions here are relative to the eye, in world axes.
#ifndef GNOMON_VOLUMES_RECEIVER_TILE_H
#define GNOMON_VOLUMES_RECEIVER_TILE_H
#include "volume.h"

GN_SHARED_BEGIN

// A tile's pixels. Its strips are what one invocation of receiver_strips.comp looks at; a workgroup has STRIP_GROUP.
// The first of a row begins at a multiple of FOUR, as many as are read at once, not right of the area's first pixel.
GN_SHARED_CONST uint TILE_ROWS = 32u;
GN_SHARED_CONST uint TILE_COLUMNS = 32u;
GN_SHARED_CONST uint STRIP_ROWS = 4u;
GN_SHARED_CONST uint STRIPS_A_TILE = TILE_ROWS / STRIP_ROWS;
GN_SHARED_CONST uint STRIP_GROUP = 64u;
GN_SHARED_CONST uint FOUR = 4u;

// Receivers of a tile, or of one of its strips. lower.x > upper.x: none.
struct ReceiverTile {
    vec4 lower;       // xyz: bounds; w: 1 if a pixel of it shows no receiver
    vec4 upper;       // xyz
    vec4 normalLower; // xyz: bounds of the geometric normals, where there are any
    vec4 normalUpper;
};
GN_SHARED_SIZE(ReceiverTile, 64)

// How much a box of receivers is widened, metres: by far more than depth values, view rays and the rasteriser's 1/256
// pixel can be off (2^-10 of the distance from the eye is two thirds of a whole pixel of 1/700 radian).
GN_SHARED_FN float receiverMargin(vec3 lower, vec3 upper)
{
    vec3 farthest = max(abs(lower), abs(upper));
    return 1e-3f + (1.0f / 1024.0f) * max(farthest.x, max(farthest.y, farthest.z));
}

// Between half the offset, below which pixels come out wrong whose answer is clear, and all of it: the way along the
// view ray also leads along the surface, and costs pixels without a clear answer. Eight lights in `colonnade`,
// 1280x720: 1, 0 and 0 clear pixels, and 0.0029, 0.0036 and 0.0049 % of all, with 1/2, this and 1.
GN_SHARED_CONST float LIFT = 0.7071f;
// Surfaces seen closer to their edge are lifted no farther: a quarter of a pixel's footprint along the ray.
GN_SHARED_CONST float LEAST_LIFT_COSINE = 1.0f / 64.0f;
// Where the host gives no normals: the mean between a pixel's ray and a surface without a favoured direction.
GN_SHARED_CONST float MEAN_LIFT_COSINE = 2.0f / 3.0f;

// What liftedDepth() asks of a view.
struct DepthLift {
    float share; // of depth * mul + back that a receiver is moved by, seen straight on
    float mul;   // depth * mul + back: in proportion to 1 / linear depth; orthographic: what a pixel's width is
    float back;
    float step;  // one unit of integer depths, towards the eye
};

GN_SHARED_FN DepthLift depthLift(ViewConstants view)
{
    DepthLift lift;
    lift.share = view.offsetFactor * LIFT / 256.0f * view.pixelSize;
    lift.mul = isOrthographic(view) ? 0.0f : 1.0f;
    lift.back = isOrthographic(view) ? -1.0f / view.rayDepthWs.w : view.depthAdd / view.depthMul;
    float step = view.offsetFactor * view.eyeWs.w;
    lift.step = view.skyDepth == 0.0f ? step : -step; // reversed: depth falls with distance
    return lift;
}

// The depth value of a receiver moved towards the eye until it is the offset of receiver.h above its surface. There
// rays start, and there counts have to be asked for; on the surface itself, sheets that rise from a concave edge of the
// receiver's own mesh are closer than depths are exact. Along the view ray, so that it stays in its pixel, that is
// 1 / |n.v| of the offset: of its terms that of the footprint, times LIFT. The float's ulp is left out, because volumes
// are rasterised with the same ulp as receivers, and so is the rounding of rays; one unit of integer depths is not.
//
//   cosine  |n.ray|, the ray of linear depth 1; orthographic: of unit length
GN_SHARED_FN float liftedDepth(DepthLift lift, float depth, float cosine)
{
    float inverse = depth * lift.mul + lift.back;
    return min(max(depth + (inverse * (lift.share / max(cosine, LEAST_LIFT_COSINE)) + lift.step), 0.0f), 1.0f);
}

// What a light is to a tile, bits. TILE_REACHED alone: all of its pixels show receivers that the light reaches and that
// face it, so that the count decides.
GN_SHARED_CONST uint TILE_UNREACHED = 0u; // no receiver is reached: visibility is 1
GN_SHARED_CONST uint TILE_REACHED = 1u;   // some are, or all
GN_SHARED_CONST uint TILE_PARTLY = 2u;    // and perhaps not in every pixel
GN_SHARED_CONST uint TILE_TURNED = 4u;    // some may face away

// TILE_UNREACHED, TILE_REACHED and maybe TILE_PARTLY by reaches() for the points in a box around the light.
//   lower, upper  bounds of the ways from the light
//   cone, rangeSquared  of reaches()
// r sin(angle to the axis - half angle) is positive outside the cone, and changes by no more than a point moves: so a
// sphere around the box says it for all of it. Rounding is 2^-22 of the terms, and the boxes are wider than that by
// their margin already.
GN_SHARED_FN uint tileReached(vec3 lower, vec3 upper, vec4 cone, float rangeSquared)
{
    vec3 nearest = max(max(lower, -upper), vec3(0.0f, 0.0f, 0.0f));
    vec3 farthest = max(abs(lower), abs(upper));
    if (dot(nearest, nearest) > rangeSquared) return TILE_UNREACHED;
    bool within = dot(farthest, farthest) <= rangeSquared;
    if (cone.w < -1.0f) return within ? TILE_REACHED : TILE_REACHED | TILE_PARTLY;
    vec3 center = 0.5f * (lower + upper);
    float along = dot(center, vec3(cone)), across = sqrt(max(dot(center, center) - along * along, 0.0f));
    float cosine = sqrt(abs(cone.w)), sine = sqrt(1.0f - abs(cone.w));
    float outside = (cone.w < 0.0f ? -cosine : cosine) * across - sine * along;
    float radius = 0.5f * length(upper - lower) + 1e-3f * length(center);
    if (outside > radius) return TILE_UNREACHED;
    return within && outside < -radius ? TILE_REACHED : TILE_REACHED | TILE_PARTLY;
}

// Least of dot(a, b) over two boxes.
GN_SHARED_FN float leastDot(vec3 aLower, vec3 aUpper, vec3 bLower, vec3 bUpper)
{
    vec3 least = min(min(aLower * bLower, aLower * bUpper), min(aUpper * bLower, aUpper * bUpper));
    return least.x + least.y + least.z;
}

GN_SHARED_FN uint tileAnswer(ReceiverTile tile, VolumeResolve resolve)
{
    vec3 lower = vec3(tile.lower), upper = vec3(tile.upper), light = vec3(resolve.lightEs);
    if (lower.x > upper.x) return TILE_UNREACHED;
    float margin = receiverMargin(lower, upper);
    vec3 fromLower = resolve.lightEs.w * (lower - margin) - light,
         fromUpper = resolve.lightEs.w * (upper + margin) - light;
    uint answer = tileReached(fromLower, fromUpper, resolve.cone, resolve.rangeSquared);
    if (answer == TILE_UNREACHED) return answer;
    if (tile.lower.w != 0.0f) answer |= TILE_PARTLY;
    vec3 farthest = max(abs(fromLower), abs(fromUpper));
    bool facing = resolve.view.hasNormals == 0u ||
                  leastDot(vec3(tile.normalLower), vec3(tile.normalUpper), -fromUpper, -fromLower) >
                      1e-5f * (farthest.x + farthest.y + farthest.z);
    return facing ? answer : answer | TILE_TURNED;
}

GN_SHARED_END
#endif
