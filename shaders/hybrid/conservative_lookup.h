// How the two layers of a conservative map are asked.
#ifndef GNOMON_HYBRID_CONSERVATIVE_LOOK_H
#define GNOMON_HYBRID_CONSERVATIVE_LOOK_H
#include "conservative.h"
#include "reasons.h"

GN_SHARED_BEGIN

struct ConservativeConstants {
    HybridConstants hybrid;
    LightConstants light;
    float texelsPerMetre; // how far a metre moves a receiver in the map, texels times w; more beside skewed casters
    float depthPerMetre;  // directional: and in depth
    float depthSquare;    // perspective: and in depth, over (depthConstant - depth)^2
    uint thesis;          // 1: depths are compared as they are
};
GN_SHARED_OFFSET(ConservativeConstants, light, 432)
GN_SHARED_SIZE(ConservativeConstants, 496)

// Where a shadow ray starts, in a map: texel, depth, and how far each may be off.
struct MapPoint {
    vec2 texel;
    float depth;
    float texelError;
    float depthError;
};

// clip: x and y in texels, times w; z of a directional light. errorWs: how far the point may be off, metres.
GN_SHARED_FN MapPoint mapPointOf(ConservativeConstants constants, vec4 clip, float errorWs)
{
    MapLookup look = constants.hybrid.base.map;
    float inverse = 1.0f / max(clip.w, 1e-20f);
    MapPoint at;
    at.texel = vec2(clip.x * inverse, clip.y * inverse);
    at.depth = look.positional != 0.0f ? look.depthConstant + look.depthScale * inverse : clip.z;
    at.texelError = errorWs * constants.texelsPerMetre * inverse + look.side * ULPS_22;
    float scaled = look.depthConstant - at.depth;
    at.depthError = ULPS_22 + errorWs * (constants.depthPerMetre + constants.depthSquare * scaled * scaled);
    return at;
}

// How far a place is from the nearest border of its texel.
GN_SHARED_FN float borderDistance(float texel)
{
    float part = texel - floor(texel);
    return min(part, 1.0f - part);
}

// Whether the map may be asked: inside its sides, not before its near end, and in a texel that is known. A point that
// may lie in the neighbouring one does so by at most RECEIVER_TEXELS, by which triangles are grown and shrunk.
GN_SHARED_FN bool mapKnows(MapPoint at, float w, float side)
{
    float room = RECEIVER_TEXELS + min(borderDistance(at.texel.x), borderDistance(at.texel.y));
    return w > 0.0f && at.depth > at.depthError && at.texelError <= room && at.texel.x >= 0.0f && at.texel.y >= 0.0f &&
           at.texel.x < side && at.texel.y < side;
}

// Whether all that is in a texel can block a ray: rays end an offset before a light with a position. Nothing in the
// texel is nearer to it than `nearest`, but 0 is any place before the near end. depthScale / (nearest - depthConstant) is
// the distance along the map's axis; twice the offset leaves room for rounding. Directional: 0 and -1, always true.
GN_SHARED_FN bool withinRays(MapLookup look, float nearest, float offset)
{
    bool placed = nearest > 0.0f || look.positional == 0.0f;
    return placed && (nearest - look.depthConstant) * (2.0f * offset) > look.depthScale;
}

// 1 lit, 0 in shadow, 0.5 unknown. nearest: nothing in the texel is nearer to the light; covered: something that covers
// the texel is not farther. Both 1 where there is nothing, wherever the point lies. blocking: of withinRays().
GN_SHARED_FN float conservativeVerdict(float nearest, float covered, float depth, float error, bool blocking)
{
    if (min(depth + error, 1.0f) <= nearest) return 1.0f;
    return blocking && min(depth - error, 1.0f) > covered ? 0.0f : 0.5f;
}

GN_SHARED_END
#endif
