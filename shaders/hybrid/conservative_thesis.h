// The thesis's form of a conservative map: depth of the plane at the texel's centre, edges that move by a fixed
// distance, kept edges (Morais 2015, 4).
#ifndef GNOMON_HYBRID_CONSERVATIVE_THESIS_H
#define GNOMON_HYBRID_CONSERVATIVE_THESIS_H
#include "conservative.h"

GN_SHARED_BEGIN

// Eq. 19 in normalised coordinates: half a texel's diagonal. In coordinates of the map it would be all of it: the
// thesis does not say which.
GN_SHARED_CONST float THESIS_TEXELS = 0.70710678f;

// By how much an edge moves, texels. flags: CASTER_TIGHT, CASTER_DIAGONAL.
GN_SHARED_FN float thesisOffset(vec4 edge, uint flags)
{
    if ((flags & CASTER_TIGHT) != 0u) return squareExtent(edge);
    return (flags & CASTER_DIAGONAL) != 0u ? 2.0f * THESIS_TEXELS : THESIS_TEXELS;
}

// Never beyond the texels that the triangle's own rectangle touches: the thesis cuts grown corners off there.
GN_SHARED_FN bool thesisTouches(ConservativeTriangle t, vec2 c, uint flags)
{
    return edgeAt(t.edge0, c) >= -thesisOffset(t.edge0, flags) && edgeAt(t.edge1, c) >= -thesisOffset(t.edge1, flags) &&
           edgeAt(t.edge2, c) >= -thesisOffset(t.edge2, flags);
}

// keep: bit i, edge i (opposite to corner i) stays in place. Where two kept edges meet, the chord between the points at
// which one crosses the other's moved line cuts the corner off: there both distances, in offsets, add up to 1. Its 1,
// 1, 2 and 4 triangles are this one rule (Morais 2015, 4.1 to 4.4).
GN_SHARED_FN bool thesisCovers(ConservativeTriangle t, vec2 c, uint keep, uint flags)
{
    float d0 = edgeAt(t.edge0, c) / thesisOffset(t.edge0, flags);
    float d1 = edgeAt(t.edge1, c) / thesisOffset(t.edge1, flags);
    float d2 = edgeAt(t.edge2, c) / thesisOffset(t.edge2, flags);
    bool keep0 = (keep & 1u) != 0u, keep1 = (keep & 2u) != 0u, keep2 = (keep & 4u) != 0u;
    return t.range.w == 0.0f && d0 >= (keep0 ? 0.0f : 1.0f) && d1 >= (keep1 ? 0.0f : 1.0f) &&
           d2 >= (keep2 ? 0.0f : 1.0f) && (!keep0 || !keep1 || d0 + d1 >= 1.0f) &&
           (!keep1 || !keep2 || d1 + d2 >= 1.0f) && (!keep2 || !keep0 || d2 + d0 >= 1.0f);
}

GN_SHARED_END
#endif
