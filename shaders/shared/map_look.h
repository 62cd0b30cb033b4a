// How receivers are looked up in a map, and what is compared there. Also part of what hosts include (sample_shadow.glsl).
#ifndef GNOMON_SHARED_MAP_LOOK_H
#define GNOMON_SHARED_MAP_LOOK_H
#include "reach.h"

GN_SHARED_BEGIN

// std140 and std430 alike. "Clip" is the map's clip space with x and y in texels: texel = clip.xy / clip.w. w is the
// linear depth of a perspective map (1 metre along its axis is 1) and 1 for a directional light.
struct MapLookup {
    mat4 clipFromRay;  // clip = clipOfEye + w * clipFromRay * (receiverRayWs(), 0), w the receiver's linear depth
    vec4 clipOfDepth;  // clipFromRay of ViewConstants::rayDepthWs
    vec4 clipOfEye;
    vec4 texelDx;      // xyz: world change of a texel's ray (directional: of its origin) per texel to the right, at w = 1
    vec4 texelDy;      // xyz: and per texel down
    vec4 axisWs;       // xyz directional: world change per unit of map depth; otherwise 0
    vec4 offset;       // offset of the receiver towards the light, metres: x + w (y + w z)
    vec4 area;         // pixels drawn: x, y, width, height
    vec4 eyeFromLight; // xyz: world, from a light with a position to the eye; w: square of its range, infinite without
    vec4 cone;         // of reaches(), receiver.h
    float depthConstant; // perspective: map depth = depthConstant + depthScale / clip.w; directional: 0 and -1
    float depthScale;
    float positional;    // 1 spot and point, 0 directional
    float side;          // texels
    float filterSide;    // texels, odd
    float slope;         // cube: half width of a face at depth 1; cascades: texels over which a map fades into the next
    float farWs;         // metres; paraboloid: distance of depth 1; other maps about a place: depth where casters end
    float kernel;        // KERNEL_*
};
GN_SHARED_OFFSET(MapLookup, depthConstant, 208)
GN_SHARED_SIZE(MapLookup, 240)

// Most texels per side of the box that a map is filtered with: the greatest value of the setting `filter`.
GN_SHARED_CONST uint MAX_FILTER_SIDE = 7u;
// And of kernels.glsl.
GN_SHARED_CONST uint MAX_KERNEL_SIDE = 15u;
// Values of the setting `kernel`.
GN_SHARED_CONST float KERNEL_BOX = 0.0f;
GN_SHARED_CONST float KERNEL_NEAREST = 1.0f;
GN_SHARED_CONST float KERNEL_TENT = 2.0f;
GN_SHARED_CONST float KERNEL_DISC = 3.0f;
GN_SHARED_CONST int DISC_TAPS = 32;
// Most texels by which the texels that vote are widened: the greatest value of the setting `widen`.
GN_SHARED_CONST int MAX_WIDEN = 3;

// Share of a texel's own slope by which a receiver is moved towards the light: rasterisers snap vertices to 1/256 texel,
// which shifts a face by up to 1/512 in x and in y; eight times that also covers interpolated depths.
GN_SHARED_CONST float SNAP_TEXELS = 1.0f / 64.0f;
// Rounding of a depth near 1, drawn and looked up: four units in the last place of a 32-bit float.
GN_SHARED_CONST float DEPTH_ROUNDING = 1.0f / 4194304.0f;

// Depth of a point of the map's clip space. Where the map has a perspective it is made of w alone: a clip z of its own
// would round apart from w, which counts t / near times at distance t.
GN_SHARED_FN float mapDepth(MapLookup look, vec4 clip)
{
    return look.positional != 0.0f ? look.depthConstant + look.depthScale / clip.w : clip.z;
}

// The depth of a receiver's plane over a map with straight edges, linear in texels: `at` the receiver's own place.
struct PlanarDepth {
    float at;
    vec2 perTexel;
};

// Perspective: the ray through texel c is L + t D(c), D linear in c; it meets the plane n.(X - P) = 0 at
// 1 / t = n.D(c) / n.(P - L), and depth = A + B / t is linear in c. Directional: the ray starts at O(c), and
// depth = n.(P - O(c)) / n.axis is too. The offset moves the plane along its normal, towards the light.
//
// depth, inverseW: of the receiver in the map's clip space. facing: n.(P - L) or n.axis, negative.
// normalPerTexel: n.texelDx and n.texelDy of MapLookup.
GN_SHARED_FN PlanarDepth planarDepth(MapLookup look, float depth, float inverseW, float facing, float offset,
                                     vec2 normalPerTexel)
{
    PlanarDepth plane;
    // The offset never takes the plane past the light.
    float away = min(facing + offset * look.positional, 0.001f * facing);
    float scale = look.depthScale / away;
    plane.perTexel = scale * normalPerTexel;
    plane.at = depth - scale * offset * inverseW;
    return plane;
}

GN_SHARED_END
#endif
