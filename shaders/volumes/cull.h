// Which shadow volumes matter to what the camera sees: boxes of visible receivers, screen tile by screen tile, against
// the shadows of casters and the umbrae of convex ones.
#ifndef GNOMON_VOLUMES_CULL_H
#define GNOMON_VOLUMES_CULL_H
#include "receiver_tile.h"

GN_SHARED_BEGIN

// Most planes that the shadow of a box has: three of its sides, and two tangents along each axis.
GN_SHARED_CONST uint SHADOW_PLANES = 9u;
// Most planes of an umbra: a box has nine; what has more is no occluder.
GN_SHARED_CONST uint UMBRA_PLANES = 16u;
// Umbrae a light: bits of ReachedTiles::needed. Those of the casters that hide most.
GN_SHARED_CONST uint UMBRAE = 16u;
GN_SHARED_CONST uint NO_UMBRA = 0xffffffffu;

GN_SHARED_CONST uint CULL_GROUP = 64u; // invocations of every compute shader here

// Candidates of one dispatch.
GN_SHARED_CONST uint CANDIDATES = 256u;

// What a light matters to, in the frame's coordinates.
struct ReachedBox {
    vec4 center;
    vec4 halfExtent;
};
GN_SHARED_SIZE(ReachedBox, 32)

// Where one volume can be. Planes: dot(xyz, p) + w > 0 outside, in the frame's coordinates.
struct VolumeRegion {
    vec4 shadow[9]; // SHADOW_PLANES, of the caster's bounds
    uint umbra;     // index into the umbrae, or NO_UMBRA
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_SIZE(VolumeRegion, 160)

// What one caster hides for certain.
struct UmbraRegion {
    vec4 planes[16]; // UMBRA_PLANES
};
GN_SHARED_SIZE(UmbraRegion, 256)

// What the light reaches of the view. std140.
struct ReachConstants {
    vec4 eyeWs;   // w: tiles
    vec4 lightWs; // w = 1; directional: w = 0
    vec4 axis;    // xyz: of the cone; w: cosine of its half angle, -1 for none
    float sine;   // of the half angle
    float range;
    uint tileCount;
    uint umbraMask; // umbrae that may be used
};
GN_SHARED_SIZE(ReachConstants, 64)

// A volume that may be drawn, and its indirect commands in the lists.
struct CullCandidate {
    uint region;
    uint firstSide;
    uint sideCount;
    uint firstCap;
    uint capCount; // 0: it has no caps, or none are drawn
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_SIZE(CullCandidate, 32)

// std140.
struct CullConstants {
    CullCandidate candidates[256]; // CANDIDATES, a workgroup each
};
GN_SHARED_SIZE(CullConstants, 8192)

GN_SHARED_FN vec4 nowhereOutside()
{
    return vec4(0.0f, 0.0f, 0.0f, -1e30f);
}

// Whether the box lies outside the plane by more than `margin`.
GN_SHARED_FN bool boxBeyond(vec4 plane, vec3 center, vec3 halfExtent, float margin)
{
    return dot(vec3(plane), center) + plane.w - dot(abs(vec3(plane)), halfExtent) > margin;
}

// Whether the box lies inside the plane by more than `margin`.
GN_SHARED_FN bool boxWithin(vec4 plane, vec3 center, vec3 halfExtent, float margin)
{
    return dot(vec3(plane), center) + plane.w + dot(abs(vec3(plane)), halfExtent) < -margin;
}

GN_SHARED_END
#endif
