// The penumbra of one silhouette edge: where it lies, and how much of the light's disc the edge covers or uncovers.
//
// Coverage of a unit disc by an outline is a sum over its edges (Green): of the area that disc and the triangle (disc's
// centre, edge) share, with the sign of the way the edge goes round. An edge that stays outside the disc contributes
// its angle / 2 pi; and the angles of all edges together / 2 pi is the number of times that the outline goes round the
// centre, which the stencil has counted. What is left to an edge is the difference between area / pi and angle / 2 pi,
// which is zero unless the edge enters the disc.
#ifndef GNOMON_VOLUMES_WEDGE_H
#define GNOMON_VOLUMES_WEDGE_H
#include "volume.h"

GN_SHARED_BEGIN

// What wedge.frag asks of view and light. std140.
struct WedgeConstants {
    ViewConstants view;
    vec4 lightEs;      // xyz metres; w: radius of the source, metres
    uint depthColumns; // in a row of the view's lifted depths
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_SIZE(WedgeConstants, 208)

// What wedge_resolve.frag asks of view and light. std140.
struct WedgeResolve {
    VolumeResolve volumes;
    int entered; // what a view ray that enters a volume adds to the count: 1, in a view that mirrors -1
    float radius; // of the source, metres
    int padding0;
    int padding1;
};
GN_SHARED_SIZE(WedgeResolve, 256)

// One caster, and which two of the hull's eight triangles are drawn.
struct WedgePush {
    VolumePush caster;
    uint part;     // 0 to WEDGE_PARTS - 1
    uint before;   // 1: the hull's near side is drawn, 0: its far side
    uint mirrored; // 1: the view mirrors, triangles are drawn the other way round
    uint padding;
};
GN_SHARED_SIZE(WedgePush, 80)

GN_SHARED_CONST uint WEDGE_PARTS = 4u;

// The hull of all points whose way to some point of the source crosses the edge: a wedge with the edge as its ridge. It
// has no end; six corners, of which 0 and 1 are the edge's ends and 2 to 5 lie on the rays.
struct Wedge {
    vec3 rays[4]; // from `from` left and right, from `to` left and right
    float whole;  // 1: the source is too close to the edge's line, the penumbra has no such hull or too wide a one
};

// How far from the source's centre, in radii, a ray of a hull passes at most. Two of its planes meet in it, which touch
// the source and whose normals have the cosine c: sqrt(2 / (1 + c)) radii. That is 1.41 for edges that stand across
// their light, and would grow to 10 for those that point past the source; a few more of these then have no hull. It
// tells shadow_reach.cpp which hulls may hold the eye.
GN_SHARED_CONST float WEDGE_SPREAD = 3.0f;

// In the plane across the edge the source is a disc of the same radius at the distance rho from the edge: the ridge's
// two planes touch it. In the plane of edge and light it is another one, and the planes at either end touch that one.
// Both exist if the source does not reach the edge's line; two hundredths more, or tangents grow without bounds.
GN_SHARED_FN Wedge penumbraWedge(vec3 from, vec3 to, vec3 light, float radius)
{
    float edgeLength = length(to - from);
    vec3 along = (to - from) / edgeLength;
    vec3 toLight = light - from;
    float ahead = dot(toLight, along);
    vec3 away = along * ahead - toLight;
    float rho = length(away);
    Wedge wedge;
    vec3 x = away / rho, y = cross(along, x);
    float side = radius / sqrt(max(rho * rho - radius * radius, 1e-30f));
    // Tangents of half the angle under which each end sees the source, then slopes: those of the light's ray through
    // the end, turned outwards by that angle.
    float behind = ahead - edgeLength;
    float square = rho * rho - radius * radius;
    float atFrom = radius / sqrt(max(square + ahead * ahead, 1e-30f));
    float atTo = radius / sqrt(max(square + behind * behind, 1e-30f));
    float slopeFrom = (-ahead - rho * atFrom) / (rho - ahead * atFrom);
    float slopeTo = (-behind + rho * atTo) / (rho + behind * atTo);
    // Of the planes' normals the cosine, where it is negative.
    float lean = max(max(slopeFrom, -slopeTo), 0.0f);
    float opposed = radius / rho * lean / sqrt(1.0f + lean * lean);
    bool narrow = rho > 1.02f * radius && opposed < 1.0f - 2.0f / (WEDGE_SPREAD * WEDGE_SPREAD);
    wedge.whole = narrow ? 0.0f : 1.0f;
    wedge.rays[0] = x + side * y + slopeFrom * along;
    wedge.rays[1] = x - side * y + slopeFrom * along;
    wedge.rays[2] = x + side * y + slopeTo * along;
    wedge.rays[3] = x - side * y + slopeTo * along;
    return wedge;
}

// Corners of the hull's triangles, two a part, counter-clockwise from outside: left side, right side, both ends, far
// side.
GN_SHARED_FN uint wedgeCorner(uint part, uint corner)
{
    // Six corners a part, four bits each, the first one lowest.
    uint corners = part == 0u ? 0x240410u : part == 1u ? 0x150530u : part == 2u ? 0x451320u : 0x352542u;
    return (corners >> (4u * corner)) & 7u;
}

// The corner of a part that is drawn `index`-th: in a view that mirrors, triangles go round the other way.
GN_SHARED_FN uint drawnCorner(uint part, uint index, bool mirrored)
{
    uint turn = index % 3u;
    return wedgeCorner(part, mirrored ? index - turn + (3u - turn) % 3u : index);
}

// Of all edges at a pixel one number is kept: the sum of their shares, and DOUBT for each that may be off by a disc.
// Shares add up to half a disc a caster, so to less than half of it under five hundred; of what is left behind it a
// float keeps 2^-14 while one edge is in doubt, 2^-11 while eight are: less than a byte of visibility tells apart.
GN_SHARED_CONST float DOUBT = 512.0f;

GN_SHARED_FN float sharesOf(float sum)
{
    return sum - DOUBT * floor(sum / DOUBT + 0.5f);
}
GN_SHARED_FN bool doubtful(float sum)
{
    return sum > 0.5f * DOUBT;
}

// What an edge adds to the stencil's count, in discs, and how certain that is.
struct EdgeShare {
    float share;
    // Metres from the receiver to the plane through light and edge where that plane decides the count, else a large
    // number. Closer than rounding, stencil and share may disagree about the side, and their sum is off by one.
    float clearance;
};

// @param from, to, light   relative to the receiver, metres; the outside lies to the right of the edge, seen from the
// light
// @param radius            of the source
GN_SHARED_FN EdgeShare edgeShare(vec3 from, vec3 to, vec3 light, float radius)
{
    EdgeShare nothing;
    nothing.share = 0.0f;
    nothing.clearance = 1e30f;
    float lightDistance = length(light);
    vec3 d = light / lightDistance;
    // Only what lies between receiver and light covers anything. A hundred-thousandth of the way: floats know the
    // receiver no better.
    float tFrom = dot(from, d), tTo = dot(to, d), nearest = 1e-5f * lightDistance;
    float t0 = clamp(tFrom, nearest, lightDistance), t1 = clamp(tTo, nearest, lightDistance);
    float rise = tTo - tFrom;
    bool level = abs(rise) < 1e-12f;
    float s0 = level ? 0.0f : clamp((t0 - tFrom) / rise, 0.0f, 1.0f);
    float s1 = level ? 1.0f : clamp((t1 - tFrom) / rise, 0.0f, 1.0f);
    // The plane of receiver and edge meets the disc in a line: `beside` radii from its centre, in the direction g.
    vec3 n = cross(from, to);
    float side = dot(n, d);
    vec3 across = n - side * d;
    float size = length(across);
    float beside = lightDistance * abs(side) / (radius * max(size, 1e-30f));
    vec3 g = cross(d, across) / max(size, 1e-30f);
    float halfChord = sqrt(max(1.0f - beside * beside, 0.0f));
    float scale = lightDistance / radius;
    float u0 = clamp(scale * dot(from + s0 * (to - from), g) / t0, -halfChord, halfChord);
    float u1 = clamp(scale * dot(from + s1 * (to - from), g) / t1, -halfChord, halfChord);
    bool behind = max(tFrom, tTo) <= nearest || min(tFrom, tTo) >= lightDistance;
    if (behind || beside >= 1.0f || u0 == u1) return nothing;
    // Sector less triangle, in shares of the disc: taken away where the centre is covered, added where it is not.
    float twice = beside * abs(u1 - u0);
    float outer = atan(twice, beside * beside + u0 * u1) - twice;
    EdgeShare result;
    result.share = (side > 0.0f ? -outer : outer) * (1.0f / 6.28318531f);
    bool throughCentre = min(u0, u1) <= 1e-3f && max(u0, u1) >= -1e-3f;
    result.clearance =
        throughCentre ? abs(side) / max(length(cross(from - light, to - light)), 1e-30f) * lightDistance : 1e30f;
    return result;
}

GN_SHARED_END
#endif
