// A caster's triangle by edge functions, for maps in which its edges are not straight: asked at the source place of each
// texel, it is as exact there as in a plain map.
// Source: M. Olano, T. Greer, "Triangle scan conversion using 2D homogeneous coordinates", 1997: no clipping at the
// light's plane.
//
// A corner is V = (x w, y w, w), x and y in source texels, w its distance along the axis of a perspective and 1 for a
// directional light. The edge from Vj to Vk is the plane N = Vj x Vk through the light; a texel's ray (c, 1) is the sum
// of the corners weighted by N.(c, 1) over the volume V0.(V1 x V2).
#ifndef GNOMON_WARPED_TRIANGLE_H
#define GNOMON_WARPED_TRIANGLE_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint WARP_CASTER_PERSPECTIVE = 1u;
GN_SHARED_CONST uint WARP_CASTER_BACK_ONLY = 2u; // only faces turned away from the light
GN_SHARED_CONST uint WARP_CASTER_MIRRORED = 4u;  // the winding is reversed
GN_SHARED_CONST uint WARP_CASTER_UNSEEN = 8u;    // drawn into a map that no receiver was counted in, and into no other

GN_SHARED_CONST uint WARP_CASTER_MAP_SHIFT = 8u; // and above: the map that is drawn

// One caster; push constants.
struct WarpCaster {
    mat4 texelFromObject; // x, y: source texels times w; z: depth of a directional light; w
    float side;           // of the map, texels
    float depthConstant;  // perspective: depth = depthConstant + depthScale / w
    float depthScale;     // paraboloid: distance of depth 1
    uint flags;
    vec4 disc; // paraboloid, where the matrix leads to its axes: x, y its centre; z texels a unit; w sine of the angle past
               // a right one that the map shows
};
GN_SHARED_OFFSET(WarpCaster, side, 64)
GN_SHARED_SIZE(WarpCaster, 96)

GN_SHARED_FN uint warpMapOf(WarpCaster caster) { return min(caster.flags >> WARP_CASTER_MAP_SHIFT, 5u); }

// What neighbours may be apart by rounding, texels: inside reaches so far.
GN_SHARED_CONST float EDGE_SLACK = 1.0f / 1024.0f;

// Places are source texels from `base`, near the triangle, so that they do not cancel.
struct WarpTriangle {
    vec3 edge0; // E(c) = x c.x + y c.y + z: distance from the edge in texels, positive inside
    vec3 edge1;
    vec3 edge2;
    vec3 plane;  // depth = x c.x + y c.y + z
    vec2 depths; // least and greatest
    vec2 base;
    vec4 box; // source texels that it may touch: lower, upper; all 0: none
};

struct SourceBounds {
    vec4 box; // lower, upper
    bool any;
};

GN_SHARED_FN SourceBounds grownTo(SourceBounds bounds, vec3 v)
{
    SourceBounds result;
    float x = v.x / v.z, y = v.y / v.z;
    result.box = vec4(min(bounds.box.x, x), min(bounds.box.y, y), max(bounds.box.z, x), max(bounds.box.w, y));
    result.any = true;
    return result;
}

// The corner a, if it lies before the light, and where the edge a -> b crosses w = `least`.
GN_SHARED_FN SourceBounds withEdge(SourceBounds bounds, vec3 a, vec3 b, float least)
{
    SourceBounds result = bounds;
    if (a.z > least) result = grownTo(result, a);
    if ((a.z > least) != (b.z > least)) {
        float share = (least - a.z) / (b.z - a.z);
        result = grownTo(result, vec3(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), least));
    }
    return result;
}

GN_SHARED_FN float warpDepthOf(WarpCaster caster, vec4 q)
{
    bool perspective = (caster.flags & WARP_CASTER_PERSPECTIVE) != 0u;
    return perspective ? caster.depthConstant + caster.depthScale / max(q.w, 1e-20f) : q.z;
}

GN_SHARED_FN vec3 fromBase(vec2 base, vec4 q)
{
    return vec3(q.x - base.x * q.w, q.y - base.y * q.w, q.w);
}

// N, its first two turned to a length of 1.
GN_SHARED_FN vec3 edgeInTexels(vec3 normal, float sign)
{
    return normal * (sign / max(length(vec2(normal.x, normal.y)), 1e-30f));
}

GN_SHARED_FN WarpTriangle noTriangle()
{
    WarpTriangle none;
    none.edge0 = none.edge1 = none.edge2 = none.plane = vec3(0.0f, 0.0f, 0.0f);
    none.depths = none.base = vec2(0.0f, 0.0f);
    none.box = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    return none;
}

GN_SHARED_FN WarpTriangle warpTriangle(WarpCaster caster, vec3 p0, vec3 p1, vec3 p2)
{
    vec4 q0 = caster.texelFromObject * vec4(p0, 1.0f);
    vec4 q1 = caster.texelFromObject * vec4(p1, 1.0f);
    vec4 q2 = caster.texelFromObject * vec4(p2, 1.0f);
    // Nearer to the light's plane than rounding: behind it.
    float least = max(abs(q0.w), max(abs(q1.w), abs(q2.w))) / 1048576.0f;
    vec2 zero = vec2(0.0f, 0.0f);
    vec3 a = fromBase(zero, q0), b = fromBase(zero, q1), c = fromBase(zero, q2);
    SourceBounds bounds;
    bounds.box = vec4(1e30f, 1e30f, -1e30f, -1e30f);
    bounds.any = false;
    bounds = withEdge(withEdge(withEdge(bounds, a, b, least), b, c, least), c, a, least);
    float grow = EDGE_SLACK + caster.side / 1048576.0f;
    vec4 box = vec4(max(bounds.box.x - grow, 0.0f), max(bounds.box.y - grow, 0.0f),
                    min(bounds.box.z + grow, caster.side), min(bounds.box.w + grow, caster.side));
    if (!bounds.any || !(box.x < box.z) || !(box.y < box.w)) return noTriangle();

    WarpTriangle t;
    t.box = box;
    t.base = vec2(floor(0.5f * (box.x + box.z)), floor(0.5f * (box.y + box.w)));
    vec3 v0 = fromBase(t.base, q0), v1 = fromBase(t.base, q1), v2 = fromBase(t.base, q2);
    vec3 n0 = cross(v1, v2), n1 = cross(v2, v0), n2 = cross(v0, v1);
    float volume = dot(v0, n0); // positive where it turns away: x, y and w are right-handed
    bool away = (volume > 0.0f) != ((caster.flags & WARP_CASTER_MIRRORED) != 0u);
    bool drawn = away || (caster.flags & WARP_CASTER_BACK_ONLY) == 0u;
    // Edge-on to within rounding it covers no texel's centre.
    float rounding = (abs(v0.x * n0.x) + abs(v0.y * n0.y) + abs(v0.z * n0.z)) / 4194304.0f;
    if (!drawn || !(abs(volume) > rounding)) return noTriangle();
    float sign = volume > 0.0f ? 1.0f : -1.0f;
    t.edge0 = edgeInTexels(n0, sign);
    t.edge1 = edgeInTexels(n1, sign);
    t.edge2 = edgeInTexels(n2, sign);

    float d0 = warpDepthOf(caster, q0), d1 = warpDepthOf(caster, q1), d2 = warpDepthOf(caster, q2);
    if ((caster.flags & WARP_CASTER_PERSPECTIVE) != 0u) {
        t.plane = cross(v1 - v0, v2 - v0) * (caster.depthScale / volume); // the sum of all three, 1 / w of it
        t.plane.z += caster.depthConstant;
    } else {
        t.plane = ((d1 - d0) * n1 + (d2 - d0) * n2) * (1.0f / volume);
        t.plane.z += d0;
    }
    bool crossing = min(q0.w, min(q1.w, q2.w)) <= least;
    t.depths = vec2(crossing ? 0.0f : min(d0, min(d1, d2)), max(d0, max(d1, d2)));
    return t;
}

// Of a place from the base, and 1; or of a direction (disc_triangle.h).
GN_SHARED_FN bool holdsPlace(WarpTriangle t, vec3 at)
{
    return min(dot(t.edge0, at), min(dot(t.edge1, at), dot(t.edge2, at))) >= -EDGE_SLACK;
}

GN_SHARED_FN float triangleDepth(WarpTriangle t, vec3 at) { return clamp(dot(t.plane, at), t.depths.x, t.depths.y); }

GN_SHARED_END
#endif
