// Conservative rasterisation by edge functions: which texels of a map a triangle touches, which it covers, and between
// which depths it lies there. Nothing is extended or cut: a quad of texels around the triangle is drawn and three edge
// functions are asked at the centre of each.
// Source: J. Hasselgren, T. Akenine-Moller, L. Ohlsson, "Conservative rasterization", GPU Gems 2, ch. 42 (semi-diagonal
// of the texel projected on the edge's normal); M. Olano, T. Greer, "Triangle scan conversion using 2D homogeneous
// coordinates", 1997 (no clipping at the near end); Hertel, Hormann and Westermann 2009 (two layers).
//
// "Texels" are positions in the map: x right, y down, texel k from k to k + 1. A vertex in the map is V = (x w, y w,
// w), w its distance along the axis of a perspective and 1 for a directional light. The edge from Vj to Vk is the plane
// N = Vj x Vk through the light, and E(c) = N.(c, 1) / |N.xy| the distance of c from it in texels, where |N.xy| is
// taken.
//
// What floats leave open goes into the margins: every bound below is "value +- error", with 2^-24 a rounding.
#ifndef GNOMON_HYBRID_CONSERVATIVE_H
#define GNOMON_HYBRID_CONSERVATIVE_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// Roundings of a 32-bit float, as shares of its size.
GN_SHARED_CONST float ULPS_20 = 1.0f / 1048576.0f;
GN_SHARED_CONST float ULPS_21 = 1.0f / 2097152.0f;
GN_SHARED_CONST float ULPS_22 = 1.0f / 4194304.0f;
GN_SHARED_CONST float ULPS_23 = 1.0f / 8388608.0f;

// Flags of a caster.
GN_SHARED_CONST uint CASTER_PERSPECTIVE = 1u;
GN_SHARED_CONST uint CASTER_BACK_ONLY = 2u; // only faces turned away from the light
GN_SHARED_CONST uint CASTER_MIRRORED = 4u;  // the winding is reversed
GN_SHARED_CONST uint CASTER_KEEPS = 8u;     // edges may be kept (thesis): bits per triangle at binding 3
GN_SHARED_CONST uint CASTER_TIGHT = 16u;    // thesis: edges move by the texel's extent along their normal,
GN_SHARED_CONST uint CASTER_DIAGONAL = 32u; // or by its diagonal; else by half of that

// One caster in one map.
struct ConservativePush {
    mat4 texelFromObject; // x, y: texels times w; z: depth of a directional light; w
    float side;           // of the map, texels
    float depthConstant;  // perspective: depth = depthConstant + depthScale / w
    float depthScale;
    float texelError; // how far x and y may be off by rounding, texels times w; base shift included
    float wError;     // and w, metres
    float depthError; // of a depth: depthError + depthErrorSquare (depthConstant - depth)^2
    float depthErrorSquare;
    uint flags;
};
GN_SHARED_OFFSET(ConservativePush, side, 64)
GN_SHARED_SIZE(ConservativePush, 96)

// Share of a texel by which every triangle is grown or shrunk besides its own errors: half of it is the receiver's,
// whose place is known to RECEIVER_TEXELS; the other half covers what is computed about edges at the texel.
GN_SHARED_CONST float GUARD_TEXELS = 1.0f / 64.0f;
GN_SHARED_CONST float RECEIVER_TEXELS = 1.0f / 128.0f;

// A triangle as drawn. `rect`: first texel, and one past the last. Places are relative to texelBase(rect).
struct ConservativeTriangle {
    vec4 edge0; // E(c) = x c.x + y c.y + z; w: what E must reach for the texel at c to be touched (-w) or covered (+w)
    vec4 edge1;
    vec4 edge2;
    vec4 plane; // depth at the base, its slope per texel, w: how far depths within a texel lie from its centre's
    vec4 rect;  // empty: nothing to draw
    vec4 range; // x, y: smallest and largest depth of the triangle; z: upper bound of its slope, |dz/dx| + |dz/dy|;
                // w: 1 if it is seen edge-on, to within rounding
};

GN_SHARED_FN vec2 texelBase(vec4 rect)
{
    return vec2(floor(0.5f * (rect.x + rect.z)), floor(0.5f * (rect.y + rect.w)));
}

// Largest of x and y.
GN_SHARED_FN float sizeXY(vec3 v)
{
    return max(abs(v.x), abs(v.y));
}

// --- rectangle ---

// Bounds of points in texels, and the smallest w among them.
struct TexelBounds {
    vec4 box; // lower, upper
    float leastW;
};

GN_SHARED_FN TexelBounds grownBy(TexelBounds bounds, vec3 v)
{
    TexelBounds result;
    float x = v.x / v.z, y = v.y / v.z;
    result.box = vec4(min(bounds.box.x, x), min(bounds.box.y, y), max(bounds.box.z, x), max(bounds.box.w, y));
    result.leastW = min(bounds.leastW, v.z);
    return result;
}

// The corner `a`, if it lies before the light, and where the edge a -> b crosses w = `least`.
GN_SHARED_FN TexelBounds withCorner(TexelBounds bounds, vec3 a, vec3 b, float least)
{
    TexelBounds result = bounds;
    if (a.z > least) result = grownBy(result, a);
    if ((a.z > least) != (b.z > least)) {
        float share = (least - a.z) / (b.z - a.z);
        result = grownBy(result, vec3(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), least));
    }
    return result;
}

// Whether all corners lie on the outside of one side of the map, a texel away. True behind the light as well: the
// sides are planes through it.
GN_SHARED_FN bool outsideMap(vec3 a, vec3 b, vec3 c, float side, float error)
{
    float left = max(a.x + a.z, max(b.x + b.z, c.x + c.z));
    float top = max(a.y + a.z, max(b.y + b.z, c.y + c.z));
    float past = side + 1.0f;
    float right = min(a.x - past * a.z, min(b.x - past * b.z, c.x - past * c.z));
    float bottom = min(a.y - past * a.z, min(b.y - past * b.z, c.y - past * c.z));
    return left < -error || top < -error || right > error || bottom > error;
}

// --- edges ---

// The plane N through the light and an edge, and how far rounding may have moved it.
struct EdgePlane {
    vec3 normal;
    float errorXY; // of x and y, by this arithmetic
    float errorZ;
    float inputXY; // the same by what its corners are off
    float inputZ;
};

GN_SHARED_FN EdgePlane edgePlane(vec3 a, vec3 b, float texelError, float wError)
{
    EdgePlane edge;
    edge.normal = cross(a, b);
    float sizeA = sizeXY(a), sizeB = sizeXY(b);
    // Two products and a sum of three roundings, plus the shift to the base: four units of 2^-24.
    edge.errorXY = ULPS_22 * (sizeA * abs(b.z) + sizeB * abs(a.z));
    edge.errorZ = ULPS_21 * sizeA * sizeB;
    edge.inputXY = texelError * (abs(a.z) + abs(b.z)) + wError * (sizeA + sizeB);
    edge.inputZ = 2.0f * texelError * (sizeA + sizeB);
    return edge;
}

// E and its margin but for the texel's own offset. reach: half width and height of the rectangle, added up.
GN_SHARED_FN vec4 edgeFunction(EdgePlane edge, float sign, float reach, bool crossing, float cornerTexels)
{
    float inverse = 1.0f / max(length(vec2(edge.normal.x, edge.normal.y)), 1e-30f);
    float inputs = (edge.inputXY * reach + edge.inputZ) * inverse;
    // Before the light, corners that are off move no point of the triangle by more than they are.
    float margin = (edge.errorXY * reach + edge.errorZ) * inverse + (crossing ? inputs : min(inputs, cornerTexels));
    vec3 scaled = edge.normal * (sign * inverse);
    return vec4(scaled.x, scaled.y, scaled.z, min(margin, 1e9f));
}

// Half a texel's extent along the normal: what E falls short at the centre where the square only just touches.
GN_SHARED_FN float squareExtent(vec4 edge)
{
    return 0.5f * (abs(edge.x) + abs(edge.y));
}

// --- the whole ---

GN_SHARED_FN ConservativeTriangle nothingDrawn()
{
    ConservativeTriangle none;
    none.edge0 = none.edge1 = none.edge2 = none.plane = none.rect = none.range = vec4(0.0f);
    return none;
}

// A triangle in the map: relative to the base of its rectangle, so that places do not cancel.
struct ProjectedTriangle {
    vec3 v0;
    vec3 v1;
    vec3 v2;
    vec3 depths;  // of the corners; before the light only
    EdgePlane e0; // opposite to corner 0
    EdgePlane e1;
    EdgePlane e2;
    vec4 rect;        // empty: nothing to draw
    float reach;      // half its width and height, added up
    float leastW;     // of what lies before the light
    float texelError; // of x and y, of w, and of places in the map
    float wError;
    float cornerTexels;
    float volume; // six times that of light and triangle, positive where it turns away: x, y and w are right-handed
    float volumeError;    // by all
    float volumeRounding; // by its arithmetic alone
    bool crossing;        // a corner is not before the light
};

GN_SHARED_FN vec3 relativeTo(vec2 base, vec3 v)
{
    return vec3(v.x - base.x * v.z, v.y - base.y * v.z, v.z);
}

// The texels that the bounds touch.
GN_SHARED_FN vec4 touchedRect(TexelBounds bounds, float grow, float side)
{
    return vec4(max(floor(max(bounds.box.x - grow, -1.0f)), 0.0f), max(floor(max(bounds.box.y - grow, -1.0f)), 0.0f),
                min(floor(min(bounds.box.z + grow, side)) + 1.0f, side),
                min(floor(min(bounds.box.w + grow, side)) + 1.0f, side));
}

GN_SHARED_FN float cornerDepth(ConservativePush caster, vec4 q)
{
    bool perspective = (caster.flags & CASTER_PERSPECTIVE) != 0u;
    return perspective ? caster.depthConstant + caster.depthScale / max(q.w, 1e-20f) : q.z;
}

GN_SHARED_FN ProjectedTriangle withVolume(ProjectedTriangle triangle)
{
    ProjectedTriangle t = triangle;
    t.e0 = edgePlane(t.v1, t.v2, t.texelError, t.wError);
    t.e1 = edgePlane(t.v2, t.v0, t.texelError, t.wError);
    t.e2 = edgePlane(t.v0, t.v1, t.texelError, t.wError);
    t.volume = dot(t.v0, t.e0.normal);
    float size = sizeXY(t.v0), w = abs(t.v0.z);
    float normalXY = abs(t.e0.normal.x) + abs(t.e0.normal.y), normalZ = abs(t.e0.normal.z);
    t.volumeRounding = ULPS_21 * (size * normalXY + w * normalZ) + 2.0f * size * t.e0.errorXY + w * t.e0.errorZ;
    t.volumeError = t.texelError * normalXY + t.wError * normalZ + 2.0f * size * (t.e0.errorXY + t.e0.inputXY) +
                    w * (t.e0.errorZ + t.e0.inputZ) + t.volumeRounding;
    return t;
}

GN_SHARED_FN ProjectedTriangle projectedTriangle(ConservativePush caster, vec3 p0, vec3 p1, vec3 p2)
{
    vec4 q0 = caster.texelFromObject * vec4(p0, 1.0f);
    vec4 q1 = caster.texelFromObject * vec4(p1, 1.0f);
    vec4 q2 = caster.texelFromObject * vec4(p2, 1.0f);
    ProjectedTriangle t;
    t.v0 = vec3(q0.x, q0.y, q0.w);
    t.v1 = vec3(q1.x, q1.y, q1.w);
    t.v2 = vec3(q2.x, q2.y, q2.w);
    t.depths = vec3(cornerDepth(caster, q0), cornerDepth(caster, q1), cornerDepth(caster, q2));
    float greatestW = max(abs(q0.w), max(abs(q1.w), abs(q2.w)));
    float least = 4.0f * caster.wError + 1e-20f; // nearer to the light's plane than rounding: behind it
    t.texelError = caster.texelError + ULPS_22 * caster.side * greatestW;
    t.wError = caster.wError + ULPS_23 * greatestW;

    TexelBounds bounds;
    bounds.box = vec4(1e30f, 1e30f, -1e30f, -1e30f);
    bounds.leastW = 1e30f;
    bounds = withCorner(bounds, t.v0, t.v1, least);
    bounds = withCorner(bounds, t.v1, t.v2, least);
    bounds = withCorner(bounds, t.v2, t.v0, least);
    t.leastW = bounds.leastW;
    t.cornerTexels = t.texelError / bounds.leastW;
    t.crossing = min(q0.w, min(q1.w, q2.w)) <= least;
    bool behind = bounds.leastW > 1e29f;
    bool outside = behind || outsideMap(t.v0, t.v1, t.v2, caster.side, t.texelError);
    t.rect = outside ? vec4(0.0f) : touchedRect(bounds, t.cornerTexels + GUARD_TEXELS, caster.side);
    t.reach = 0.5f * (t.rect.z - t.rect.x + t.rect.w - t.rect.y) + 2.0f;
    vec2 base = texelBase(t.rect);
    t.v0 = relativeTo(base, t.v0);
    t.v1 = relativeTo(base, t.v1);
    t.v2 = relativeTo(base, t.v2);
    return withVolume(t);
}

// Smallest and largest depth. Before the near end of a map there is nothing but 0.
GN_SHARED_FN vec2 depthRange(ProjectedTriangle t)
{
    return vec2(t.crossing ? 0.0f : min(t.depths.x, min(t.depths.y, t.depths.z)),
                max(t.depths.x, max(t.depths.y, t.depths.z)));
}

GN_SHARED_FN vec4 edgeOf(ProjectedTriangle t, EdgePlane edge, float sign)
{
    vec4 result = edgeFunction(edge, sign, t.reach, t.crossing, t.cornerTexels);
    result.w += squareExtent(result) + GUARD_TEXELS;
    return result;
}

// Seen edge-on: the band around its longest edge, with its smallest depth.
GN_SHARED_FN ConservativeTriangle bandOf(ConservativePush caster, ProjectedTriangle t)
{
    // A plane through the light but for volumeError: off it by volume / w / |N.xy| texels at a point of depth w. What
    // is nearer to the light than 1/64 of the near end is as good as at the light.
    bool perspective = (caster.flags & CASTER_PERSPECTIVE) != 0u;
    float nearW = perspective ? -caster.depthScale / caster.depthConstant / 64.0f : 1.0f;
    float thickness = (abs(t.volume) + t.volumeError) / max(t.leastW, nearW);
    float size0 = length(vec2(t.e0.normal.x, t.e0.normal.y)), size1 = length(vec2(t.e1.normal.x, t.e1.normal.y));
    float size2 = length(vec2(t.e2.normal.x, t.e2.normal.y));
    float size = max(size0, max(size1, size2));
    vec4 edge;
    if (size0 == size)
        edge = edgeOf(t, t.e0, 1.0f);
    else if (size1 == size)
        edge = edgeOf(t, t.e1, 1.0f);
    else
        edge = edgeOf(t, t.e2, 1.0f);
    float margin = edge.w + thickness / max(size, 1e-30f);
    vec2 depths = depthRange(t);
    ConservativeTriangle band;
    band.edge0 = vec4(edge.x, edge.y, edge.z, margin);
    band.edge1 = vec4(-edge.x, -edge.y, -edge.z, margin);
    band.edge2 = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    band.plane = vec4(depths.x, 0.0f, 0.0f, 0.0f);
    band.rect = t.rect;
    band.range = vec4(depths.x, depths.y, 0.0f, 1.0f);
    return band;
}

// Sum of the edges' normals, weighted so that its value at (c, 1) over the volume is what depth is made of, and how far
// it may be off. Perspective: (c, 1) is the corners' sum weighted by E, and 1 / w is the sum of the weights, N0 + N1 +
// N2 of it, the cross product of two sides. Directional: weights times depths, from the first's.
struct DepthWeights {
    vec3 normal;
    float errorXY;
    float errorZ;
};

GN_SHARED_FN DepthWeights depthWeights(ProjectedTriangle t, bool perspective)
{
    vec3 side1 = t.v1 - t.v0, side2 = t.v2 - t.v0;
    float size1 = sizeXY(side1), size2 = sizeXY(side2);
    DepthWeights weights;
    if (perspective) {
        weights.normal = cross(side1, side2);
        weights.errorXY = ULPS_21 * (size1 * abs(side2.z) + size2 * abs(side1.z));
        weights.errorZ = ULPS_20 * size1 * size2;
    } else {
        float rise1 = t.depths.y - t.depths.x, rise2 = t.depths.z - t.depths.x;
        float rise = max(abs(rise1), abs(rise2));
        weights.normal = rise1 * t.e1.normal + rise2 * t.e2.normal;
        weights.errorXY =
            rise * (2.0f * (t.e1.errorXY + t.e2.errorXY) + ULPS_22 * (sizeXY(t.e1.normal) + sizeXY(t.e2.normal)));
        weights.errorZ =
            rise * (2.0f * (t.e1.errorZ + t.e2.errorZ) + ULPS_22 * (abs(t.e1.normal.z) + abs(t.e2.normal.z)));
    }
    if (t.crossing) { // corners that are off turn the plane; otherwise they move points of it, by as much
        weights.errorXY += 4.0f * (t.texelError * (abs(side1.z) + abs(side2.z)) + t.wError * (size1 + size2));
        weights.errorZ += 4.0f * t.texelError * (size1 + size2);
    }
    return weights;
}

GN_SHARED_FN ConservativeTriangle withDepths(ConservativeTriangle triangle, ConservativePush caster,
                                             ProjectedTriangle t)
{
    bool perspective = (caster.flags & CASTER_PERSPECTIVE) != 0u;
    DepthWeights weights = depthWeights(t, perspective);
    float scale = (perspective ? caster.depthScale : 1.0f) / t.volume;
    float relative = (t.crossing ? t.volumeError : t.volumeRounding) / abs(t.volume);
    vec3 slope = weights.normal * scale;
    float start = perspective ? caster.depthConstant : t.depths.x;
    float slopes = abs(slope.x) + abs(slope.y);
    float slopeError = 2.0f * (abs(scale) * weights.errorXY + relative * slopes);
    float farthest = min(abs(slope.z) + slopes * t.reach, 1.0f);
    float slack = abs(scale) * (weights.errorXY * t.reach + weights.errorZ) + relative * farthest + ULPS_23;
    // To any point of the texel's square, and as far as corners may be off besides.
    float around = 0.5f + GUARD_TEXELS + (t.crossing ? 0.0f : t.cornerTexels);
    vec2 depths = depthRange(t);
    ConservativeTriangle result = triangle;
    result.plane = vec4(start + slope.z, slope.x, slope.y, around * slopes + slack);
    result.range = vec4(depths.x, depths.y, slopes + slopeError, 0.0f);
    // Too close to edge-on to say anything by its plane.
    if (!(result.plane.w < 1e9f)) result.plane = vec4(depths.x, 0.0f, 0.0f, 1e9f);
    return result;
}

// A triangle with corners in object space.
GN_SHARED_FN ConservativeTriangle conservativeTriangle(ConservativePush caster, vec3 p0, vec3 p1, vec3 p2)
{
    ProjectedTriangle t = projectedTriangle(caster, p0, p1, p2);
    if (!(t.rect.x < t.rect.z && t.rect.y < t.rect.w)) return nothingDrawn();
    if (!(abs(t.volume) > t.volumeError)) return bandOf(caster, t);
    bool away = ((caster.flags & CASTER_MIRRORED) != 0u) != (t.volume > 0.0f);
    if ((caster.flags & CASTER_BACK_ONLY) != 0u && !away) return nothingDrawn();

    float sign = t.volume > 0.0f ? 1.0f : -1.0f;
    ConservativeTriangle triangle = nothingDrawn();
    triangle.edge0 = edgeOf(t, t.e0, sign);
    triangle.edge1 = edgeOf(t, t.e1, sign);
    triangle.edge2 = edgeOf(t, t.e2, sign);
    triangle.rect = t.rect;
    return withDepths(triangle, caster, t);
}

// --- at a texel: c its centre relative to the base ---

GN_SHARED_FN float edgeAt(vec4 edge, vec2 c)
{
    return edge.x * c.x + edge.y * c.y + edge.z;
}

GN_SHARED_FN bool touches(ConservativeTriangle t, vec2 c)
{
    return edgeAt(t.edge0, c) >= -t.edge0.w && edgeAt(t.edge1, c) >= -t.edge1.w && edgeAt(t.edge2, c) >= -t.edge2.w;
}
GN_SHARED_FN bool covers(ConservativeTriangle t, vec2 c)
{
    return t.range.w == 0.0f && edgeAt(t.edge0, c) >= t.edge0.w && edgeAt(t.edge1, c) >= t.edge1.w &&
           edgeAt(t.edge2, c) >= t.edge2.w;
}

// Whether the centre lies on the triangle beyond doubt: by more than the edges may be off.
GN_SHARED_FN bool edgeHolds(vec4 edge, vec2 c)
{
    return edgeAt(edge, c) >= edge.w - squareExtent(edge) - GUARD_TEXELS;
}
GN_SHARED_FN bool holds(ConservativeTriangle t, vec2 c)
{
    return t.range.w == 0.0f && edgeHolds(t.edge0, c) && edgeHolds(t.edge1, c) && edgeHolds(t.edge2, c);
}

GN_SHARED_FN float depthAt(ConservativeTriangle t, vec2 c)
{
    return t.plane.x + t.plane.y * c.x + t.plane.z * c.y;
}

// What a depth may be off because places are.
GN_SHARED_FN float depthErrorAt(float constant, float error, float errorSquare, float depth)
{
    float inverse = constant - depth; // perspective: a multiple of 1 / w
    return error + errorSquare * inverse * inverse;
}

// Nothing of the triangle is nearer to the light in the texel. Below 1: what casts is told from nothing.
GN_SHARED_FN float nearDepth(ConservativePush caster, ConservativeTriangle t, vec2 c)
{
    float depth = max(t.range.x, depthAt(t, c) - t.plane.w);
    depth -= depthErrorAt(caster.depthConstant, caster.depthError, caster.depthErrorSquare, depth);
    return min(max(depth, 0.0f), 1.0f - ULPS_23);
}

// Nothing of the triangle is farther from the light in a texel that it covers.
GN_SHARED_FN float farDepth(ConservativePush caster, ConservativeTriangle t, vec2 c)
{
    float depth = min(t.range.y, depthAt(t, c) + t.plane.w);
    float nearest = max(t.range.x, depthAt(t, c) - t.plane.w);
    depth += depthErrorAt(caster.depthConstant, caster.depthError, caster.depthErrorSquare, nearest);
    return max(depth, 0.0f);
}

// --- sheets: faces that stay together in a texel which no border of theirs touches ---

// 0: a border or an edge-on face does; 1: no face is there. Slopes as depths: the largest wins a depth test LESS;
// 1/1024 a texel is half.
GN_SHARED_CONST float SLOPE_UNIT = 1024.0f;
GN_SHARED_FN float slopeAsDepth(float slope)
{
    return min(1.0f / (1.0f + SLOPE_UNIT * slope), 1.0f - ULPS_23);
}
// Rounded up: both divisions and what is stored are exact to 2^-21 of the sum.
GN_SHARED_FN float slopeOfDepth(float depth)
{
    return (1.0f / depth * (1.0f + ULPS_20) - 1.0f) / SLOPE_UNIT;
}

// The errors of the casters of a map, the largest of each; as in ConservativePush.
struct SheetErrors {
    float side;
    float depthConstant;
    float inverseScale; // perspective: 1 / depthScale; directional: 0
    float texelError;
    float depthError;
    float depthErrorSquare;
};

// Nothing of the sheet that has `centre` as its depth at the texel's centre is farther from the light in the texel,
// where no face is steeper than `slope`: from the centre every point of the square is half a texel away in x and in y.
// Centre and slope are those of corners that may be off by texelError; so may the truth.
GN_SHARED_FN float sheetDepth(SheetErrors errors, float centre, float slope)
{
    float inverseW = errors.inverseScale != 0.0f ? (centre - errors.depthConstant) * errors.inverseScale : 1.0f;
    float reach = 0.5f + GUARD_TEXELS + 2.0f * (errors.texelError * inverseW + errors.side * ULPS_22);
    float rise = reach * slope;
    float nearest = centre - rise;
    return centre + rise + DEPTH_ROUNDING +
           depthErrorAt(errors.depthConstant, errors.depthError, errors.depthErrorSquare, nearest);
}

GN_SHARED_END
#endif
