// Silhouette revectorization: the stairs that the texels of a map make of a shadow's edge become the lines through
// their corners or their middles; C++, GLSL and HLSL. Source: Macedo 2018, 3.1 to 4.1.1, Eqs 3.1 to 3.9 and 4.2.
//
// The includer declares what is asked of a map, before:
//   struct Tap                                  a receiver and its place in the map
//   bool texelLit(Tap tap, vec2 centre)         whether a texel lets light through to the receiver's plane
//   bool texelExists(Tap tap, vec2 centre)      whether the map has it; what it has not ends no shadow and no stair
#ifndef GNOMON_REVECTORIZED_REVECTORIZE_H
#define GNOMON_REVECTORIZED_REVECTORIZE_H
#include "stairs.h"

GN_SHARED_BEGIN

// Sides of a texel beyond which the map says otherwise (Eq 3.3): low and high x, low and high y.
GN_SHARED_CONST uint EDGE_LOW_X = 1u;
GN_SHARED_CONST uint EDGE_HIGH_X = 2u;
GN_SHARED_CONST uint EDGE_LOW_Y = 4u;
GN_SHARED_CONST uint EDGE_HIGH_Y = 8u;

GN_SHARED_FN bool texelDiffers(Tap tap, vec2 centre, bool lit)
{
    return texelExists(tap, centre) && texelLit(tap, centre) != lit;
}

GN_SHARED_FN uint texelEdges(Tap tap, vec2 centre, bool lit)
{
    uint lowX = texelDiffers(tap, centre - vec2(1.0f, 0.0f), lit) ? EDGE_LOW_X : 0u;
    uint highX = texelDiffers(tap, centre + vec2(1.0f, 0.0f), lit) ? EDGE_HIGH_X : 0u;
    uint lowY = texelDiffers(tap, centre - vec2(0.0f, 1.0f), lit) ? EDGE_LOW_Y : 0u;
    uint highY = texelDiffers(tap, centre + vec2(0.0f, 1.0f), lit) ? EDGE_HIGH_Y : 0u;
    return lowX | highX | lowY | highY;
}

// How far the stairs at a receiver go on to each side, and which of them end at a texel that says otherwise: there the
// edge turns, and the stair is closed.
struct StairEnds {
    vec4 texels; // beside the receiver's own: low and high x, low and high y
    uint closed; // EDGE_*
};

GN_SHARED_FN StairEnds noSteps()
{
    StairEnds ends;
    ends.texels = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    ends.closed = 0u;
    return ends;
}

// Follows the stairs from the receiver's texel: texels that say the same, beside a wall of the receiver's own texel
// that goes along with the way. All four ways in one loop: invocations that run together wait for the longest sum, not
// for the longest of each.
//   edges     of texelEdges()
//   ends      what is known
//   ways      EDGE_*: where to follow on
//   longest   texels; a way beyond that is open
GN_SHARED_FN StairEnds stairEnds(Tap tap, vec2 centre, bool lit, uint edges, StairEnds ends, uint ways, uint longest)
{
    longest = min(longest, MAX_STAIR);
    uint way = ways == 0u ? 4u : 0u;
    while (way < 4u) { // bound: 4 MAX_STAIR
        bool asked = (ways >> way & 1u) != 0u;
        float to = (way & 1u) == 0u ? -1.0f : 1.0f;
        bool alongX = way < 2u;
        vec2 across = alongX ? vec2(0.0f, 1.0f) : vec2(1.0f, 0.0f);
        uint walls = alongX ? edges >> 2 : edges; // bits 0 and 1: on the lower and the higher side of the way
        float steps = ends.texels[int(way)] + 1.0f;
        vec2 there = centre + to * steps * vec2(across.y, across.x);
        bool closed = asked && texelDiffers(tap, there, lit);
        bool beside = asked && (((walls & 1u) != 0u && texelDiffers(tap, there - across, lit)) ||
                                ((walls & 2u) != 0u && texelDiffers(tap, there + across, lit)));
        bool goesOn = beside && !closed;
        ends.closed |= closed ? 1u << way : 0u;
        ends.texels[int(way)] += goesOn ? 1.0f : 0.0f;
        if (!goesOn || steps >= float(longest)) {
            // An edge that does not turn along x is straight: nothing to be asked along y.
            way = way == 1u && (ends.closed & 3u) == 0u ? 4u : way + 1u;
        }
    }
    return ends;
}

// The place of a receiver along an axis of its stair: 0 where the edge turns, 1 at the other end, or in the middle if
// it turns at both. Eq 3.5 without signs; with the length clamped as in the thesis's listing A.4.
//   low, high  texels to either end; bits 0 and 1 of `closed`, not both 0: which are closed
GN_SHARED_FN float stairPlace(float low, float high, uint closed, uint longest)
{
    float nearest = closed == 3u ? 2.0f * min(low, high) : closed == 1u ? low : high;
    return nearest / min(low + high, float(longest));
}

// Sum of the places on both stairs; -1 where the edge turns along one axis at most: the map's answer stays.
GN_SHARED_FN float stairPlaces(StairEnds ends, vec2 inTexel, uint longest)
{
    uint alongX = ends.closed & 3u, alongY = ends.closed >> 2;
    if (alongX == 0u || alongY == 0u) return -1.0f;
    return stairPlace(ends.texels.x + inTexel.x, ends.texels.y + 1.0f - inTexel.x, alongX, longest) +
           stairPlace(ends.texels.z + inTexel.y, ends.texels.w + 1.0f - inTexel.y, alongY, longest);
}

// Visibility from the places on both stairs of a receiver whose texel says `lit`.
GN_SHARED_FN float revectorizedAt(bool lit, float place, uint mode)
{
    if (mode == REVECTORIZE_CONSERVATIVE) return lit && place >= 1.0f ? 1.0f : 0.0f;
    if (mode == REVECTORIZE_NONCONSERVATIVE) return lit != (place < 0.5f) ? 1.0f : 0.0f;
    float ramp = clamp(place, 0.0f, 1.0f);
    return lit ? ramp : 1.0f - ramp;
}

//   at       the receiver in the map, texels
//   longest  texels that a stair is followed to each side; 0: it is not
GN_SHARED_FN float revectorizedVisibility(Tap tap, vec2 at, uint mode, uint longest)
{
    vec2 corner = floor(at), centre = corner + 0.5f;
    bool lit = texelLit(tap, centre);
    bool asked = longest > 0u && (lit || mode != REVECTORIZE_CONSERVATIVE);
    uint edges = asked ? texelEdges(tap, centre, lit) : 0u;
    StairEnds ends = stairEnds(tap, centre, lit, edges, noSteps(), edges == 0u ? 0u : 15u, longest);
    float place = stairPlaces(ends, at - corner, longest);
    return place < 0.0f ? (lit ? 1.0f : 0.0f) : revectorizedAt(lit, place, mode);
}

GN_SHARED_END
#endif
