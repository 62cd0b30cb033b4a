#version 460
// One texel of a warped map: whether the triangle lies at its source place, and at which depth.
#extension GL_GOOGLE_include_directive : require
#include "triangle.h"
#include "warped.glsl"

layout(push_constant, std430) uniform Push { WarpCaster caster; };

#define VARYING in
#include "casters_varyings.glsl"

// What the plane rises by over the texel, from its middle to a corner at most: the larger of both ways across.
float slopeBias(WarpTriangle t, uvec2 texel, vec2 place)
{
    uint map = warpMapOf(caster), last = uint(caster.side) - 1u;
    uvec2 right = uvec2(texel.x < last ? texel.x + 1u : max(texel.x, 1u) - 1u, texel.y);
    uvec2 below = uvec2(texel.x, texel.y < last ? texel.y + 1u : max(texel.y, 1u) - 1u);
    vec2 dx = placeOf(map, right, caster.side) - place, dy = placeOf(map, below, caster.side) - place;
    return max(abs(dot(t.plane.xy, dx)), abs(dot(t.plane.xy, dy)));
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
    uvec2 texel = uvec2(gl_FragCoord.xy);
    vec2 place = placeOf(warpMapOf(caster), texel, caster.side);
    vec2 c = place - base;
    bool drawn = gl_FragCoord.x < edge2AndRight.w && gl_FragCoord.y < planeAndBelow.w && holdsPlace(t, c);
    float depth = triangleDepth(t, c);
    if ((caster.flags & WARP_CASTER_BIASED) != 0u) depth += slopeBias(t, texel, place);
    // Depth 1 means that nothing is there. Before the near end there is nothing but 0.
    if (!drawn || !(depth < 1.0)) discard;
    gl_FragDepth = max(depth, 0.0);
}
