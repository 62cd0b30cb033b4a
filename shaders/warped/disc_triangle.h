// A caster's triangle in the map of a paraboloid, by the planes through the light and its edges: asked in the direction of
// each texel, it is as exact as rays are, however coarse it is.
//
// A plane through the light, of unit normal n, is a circle on the disc: its centre is n.xy / n.z, its radius 1 / |n.z|.
#ifndef GNOMON_WARPED_DISC_TRIANGLE_H
#define GNOMON_WARPED_DISC_TRIANGLE_H
#include "../shared/paraboloid.h"
#include "triangle.h"

GN_SHARED_BEGIN

// The direction, of unit length in the axes, that a place in texels shows.
GN_SHARED_FN vec3 discDirection(WarpCaster caster, vec2 place)
{
    return paraboloidDirection((place - vec2(0.5f * caster.side, 0.5f * caster.side)) / caster.disc.z +
                               vec2(caster.disc.x, caster.disc.y));
}

GN_SHARED_FN vec2 discPlace(WarpCaster caster, vec2 disc)
{
    return (disc - vec2(caster.disc.x, caster.disc.y)) * caster.disc.z + vec2(0.5f * caster.side, 0.5f * caster.side);
}

GN_SHARED_FN vec4 grownToDisc(vec4 box, vec2 disc)
{
    return vec4(min(box.x, disc.x), min(box.y, disc.y), max(box.z, disc.x), max(box.w, disc.y));
}

// Whether a direction in the plane of the edge a -> b, n = a x b of any length, lies between its ends.
GN_SHARED_FN bool isBetween(vec3 a, vec3 b, vec3 n, vec3 direction)
{
    return dot(cross(n, a), direction) >= 0.0f && dot(cross(b, n), direction) >= 0.0f;
}

// Bounds on the disc of an edge's ends and of all between them.
GN_SHARED_FN vec4 withArc(vec4 box, vec3 a, vec3 b, vec3 n)
{
    const vec4 all = vec4(-1e6f, -1e6f, 1e6f, 1e6f);
    const float straight = 1e-4f; // to within 1e-4 of the disc's radius, less than a texel's slack
    vec2 from = paraboloidDisc(a), to = paraboloidDisc(b);
    vec4 result = grownToDisc(grownToDisc(box, from), to);
    if (abs(n.z) <= straight) {
        // It may go past the point behind the light, which is everywhere at the rim.
        if (isBetween(a, b, n, vec3(0.0f, 0.0f, -1.0f))) return all;
        return result + vec4(-straight, -straight, straight, straight);
    }
    vec2 centre = vec2(n.x / n.z, n.y / n.z);
    float radius = 1.0f / abs(n.z);
    vec2 ends0 = centre - vec2(radius, radius), ends1 = centre + vec2(radius, radius);
    if (isBetween(a, b, n, paraboloidDirection(vec2(ends0.x, centre.y)))) result.x = min(result.x, ends0.x);
    if (isBetween(a, b, n, paraboloidDirection(vec2(centre.x, ends0.y)))) result.y = min(result.y, ends0.y);
    if (isBetween(a, b, n, paraboloidDirection(vec2(ends1.x, centre.y)))) result.z = max(result.z, ends1.x);
    if (isBetween(a, b, n, paraboloidDirection(vec2(centre.x, ends1.y)))) result.w = max(result.w, ends1.y);
    return result;
}

// Away from the point behind the light, where the disc has no end.
GN_SHARED_FN vec3 beforeEnd(vec3 unit) { return vec3(unit.x, unit.y, max(unit.z, -0.9999f)); }

GN_SHARED_FN vec3 unitOf(vec3 v) { return v * (1.0f / max(length(v), 1e-30f)); }

// Whether the point behind the light may lie within a triangle, by its edges.
GN_SHARED_FN bool isAround(WarpTriangle t) { return max(t.edge0.z, max(t.edge1.z, t.edge2.z)) <= 0.0f; }

// WarpTriangle::plane is 1 / depth then, along a direction, and edges are about in texels.
GN_SHARED_FN WarpTriangle discTriangle(WarpCaster caster, vec3 p0, vec3 p1, vec3 p2)
{
    vec3 v0 = GN_XYZ(caster.texelFromObject * vec4(p0, 1.0f));
    vec3 v1 = GN_XYZ(caster.texelFromObject * vec4(p1, 1.0f));
    vec3 v2 = GN_XYZ(caster.texelFromObject * vec4(p2, 1.0f));
    float farthest = max(length(v0), max(length(v1), length(v2)));
    // All of it lies past what the map shows.
    if (!(max(v0.z, max(v1.z, v2.z)) > -caster.disc.w * farthest)) return noTriangle();
    // Differences of near corners are exact in object space.
    vec3 to1 = GN_XYZ(caster.texelFromObject * vec4(p1 - p0, 0.0f));
    vec3 to2 = GN_XYZ(caster.texelFromObject * vec4(p2 - p1, 0.0f));
    vec3 to0 = GN_XYZ(caster.texelFromObject * vec4(p0 - p2, 0.0f));
    vec3 normal = cross(to1, vec3(0.0f, 0.0f, 0.0f) - to0);
    float volume = dot(v0, normal); // positive where it turns away: the axes are right-handed
    bool away = (volume > 0.0f) != ((caster.flags & WARP_CASTER_MIRRORED) != 0u);
    bool drawn = away || (caster.flags & WARP_CASTER_BACK_ONLY) == 0u;
    float rounding = (abs(v0.x * normal.x) + abs(v0.y * normal.y) + abs(v0.z * normal.z)) / 4194304.0f;
    if (!drawn || !(abs(volume) > rounding)) return noTriangle();
    float sign = volume > 0.0f ? 1.0f : -1.0f;
    vec3 n0 = unitOf(cross(v1, to2)), n1 = unitOf(cross(v2, to0)), n2 = unitOf(cross(v0, to1));

    vec3 u0 = beforeEnd(unitOf(v0)), u1 = beforeEnd(unitOf(v1)), u2 = beforeEnd(unitOf(v2));
    WarpTriangle t = noTriangle();
    vec4 box = vec4(1e6f, 1e6f, -1e6f, -1e6f);
    box = withArc(withArc(withArc(box, u0, u1, n2), u1, u2, n0), u2, u0, n1);
    t.edge0 = n0 * (sign * caster.disc.z);
    t.edge1 = n1 * (sign * caster.disc.z);
    t.edge2 = n2 * (sign * caster.disc.z);
    if (isAround(t)) box = vec4(-1e6f, -1e6f, 1e6f, 1e6f);
    vec2 low = discPlace(caster, vec2(box.x, box.y)), high = discPlace(caster, vec2(box.z, box.w));
    float grow = EDGE_SLACK + caster.side / 1048576.0f;
    box = vec4(max(low.x - grow, 0.0f), max(low.y - grow, 0.0f), min(high.x + grow, caster.side),
               min(high.y + grow, caster.side));
    if (!(box.x < box.z) || !(box.y < box.w)) return t;
    t.box = box;
    t.plane = normal * (caster.depthScale / volume);
    t.depths = vec2(abs(volume) / (max(length(normal), 1e-30f) * caster.depthScale), farthest / caster.depthScale);
    return t;
}

// In a direction.
GN_SHARED_FN float discDepth(WarpTriangle t, vec3 direction)
{
    float inverse = dot(t.plane, direction);
    return inverse > 0.0f ? clamp(1.0f / inverse, t.depths.x, t.depths.y) : t.depths.y;
}

GN_SHARED_END
#endif
