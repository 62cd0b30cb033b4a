#version 460
// One triangle over the texels of the warped map that a caster's triangle may touch, pulled by its number: twice their
// rectangle, since corners cost more than the texels past the diagonal.
#extension GL_GOOGLE_include_directive : require
#include "disc_triangle.h"
#include "warped.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Indices { uint indices[]; };
layout(constant_id = 0) const bool DISCS = false;
layout(push_constant, std430) uniform Push { WarpCaster caster; };

#define VARYING out
#include "casters_varyings.glsl"

vec3 cornerOf(uint index)
{
    uint vertex = 3u * indices[index];
    return vec3(positions[vertex], positions[vertex + 1u], positions[vertex + 2u]);
}

WarpTriangle triangleOf(vec3 a, vec3 b, vec3 c)
{
    return DISCS ? discTriangle(caster, a, b, c) : warpTriangle(caster, a, b, c);
}

// First texel, and one past the last; all the same where it touches no texel's centre.
vec4 touchedTexels(vec4 box)
{
    float side = caster.side;
    vec4 bounds = texelBox(warpMapOf(caster), box / side, side) * side;
    const float ROUNDING = 1.0 / 64.0; // texels: tables are sums
    return clamp(vec4(ceil(bounds.xy - 0.5 - ROUNDING), floor(bounds.zw - 0.5 + ROUNDING) + 1.0), 0.0, side);
}

void main()
{
    uint first = uint(gl_VertexIndex) / 3u * 3u;
    WarpTriangle t = noTriangle();
    if (isSeen(warpMapOf(caster), caster.side) != ((caster.flags & WARP_CASTER_UNSEEN) != 0u))
        t = triangleOf(cornerOf(first), cornerOf(first + 1u), cornerOf(first + 2u));
    vec4 rect = vec4(0.0);
    if (t.box.x < t.box.z) rect = touchedTexels(t.box);
    edge0AndLeast = vec4(t.edge0, t.depths.x);
    edge1AndGreatest = vec4(t.edge1, t.depths.y);
    edge2AndRight = vec4(t.edge2, rect.z);
    planeAndBelow = vec4(t.plane, rect.w);
    base = t.base;
    bool drawn = rect.x < rect.z && rect.y < rect.w;
    int corner = gl_VertexIndex - int(first);
    vec2 at = mix(rect.xy, rect.zw, vec2(corner == 1 ? 2.0 : 0.0, corner == 2 ? 2.0 : 0.0));
    // One point, which every rasteriser drops.
    gl_Position = drawn ? vec4(at / caster.side * 2.0 - 1.0, 0.0, 1.0) : vec4(0.0, 0.0, 0.0, 1.0);
}
