#version 460
// One texel of a warped map: whether the triangle lies at its source place, and at which depth.
#extension GL_GOOGLE_include_directive : require
#include "disc_triangle.h"
#include "warped.glsl"

layout(constant_id = 0) const bool DISCS = false;
layout(constant_id = 1) const bool BIASED = false; // the caster is open
layout(push_constant, std430) uniform Push { WarpCaster caster; };

#define VARYING in
#include "casters_varyings.glsl"

// What a triangle is asked with for a place.
vec3 askedAt(WarpTriangle t, vec2 place) { return DISCS ? discDirection(caster, place) : vec3(place - t.base, 1.0); }

// What its plane rises by towards a place, from another; on the disc at most by the whole range of depths.
float rise(WarpTriangle t, vec3 from, vec2 place)
{
    vec3 to = askedAt(t, place);
    if (!DISCS) return abs(dot(t.plane, to - from));
    return abs(1.0 / max(dot(t.plane, to), 1.0) - 1.0 / max(dot(t.plane, from), 1.0));
}

// What the plane rises by over the texel, from its middle to a corner at most: the larger of both ways across.
float slopeBias(WarpTriangle t, uvec2 texel, vec3 at)
{
    uint map = warpMapOf(caster), last = uint(caster.side) - 1u;
    uvec2 right = uvec2(texel.x < last ? texel.x + 1u : max(texel.x, 1u) - 1u, texel.y);
    uvec2 below = uvec2(texel.x, texel.y < last ? texel.y + 1u : max(texel.y, 1u) - 1u);
    return max(rise(t, at, texelPlace(map, right, caster.side)), rise(t, at, texelPlace(map, below, caster.side)));
}

void main()
{
    WarpTriangle t;
    t.edge0 = edge0AndLeast.xyz;
    t.edge1 = edge1AndGreatest.xyz;
    t.edge2 = edge2AndRight.xyz;
    t.plane = planeAndBelow.xyz;
    t.depths = vec2(edge0AndLeast.w, edge1AndGreatest.w);
    t.base = base;
    // The triangle is twice the rectangle.
    if (gl_FragCoord.x >= edge2AndRight.w || gl_FragCoord.y >= planeAndBelow.w) discard;
    uvec2 texel = uvec2(gl_FragCoord.xy);
    vec3 at = askedAt(t, texelPlace(warpMapOf(caster), texel, caster.side));
    float depth = DISCS ? discDepth(t, at) : triangleDepth(t, at);
    if (BIASED) depth += slopeBias(t, texel, at);
    // Depth 1 means that nothing is there. Before the near end there is nothing but 0.
    if (!holdsPlace(t, at) || !(depth < 1.0)) discard;
    gl_FragDepth = max(depth, 0.0);
}
