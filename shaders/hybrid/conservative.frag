#version 460
// One texel of a layer: is it touched, or covered, and between which depths. The depth test LESS keeps the smallest.
#extension GL_GOOGLE_include_directive : require
#include "conservative_thesis.h"

#define VARYING in
#include "conservative_varyings.glsl"

layout(constant_id = 0) const uint LAYER = LAYER_NEAR;

layout(push_constant, std430) uniform Push { ConservativePush caster; };
layout(set = 0, binding = 3, std430) readonly buffer Kept { uint kept[]; }; // four bits a triangle

uint keptEdges()
{
    if ((caster.flags & CASTER_KEEPS) == 0u) return 0u;
    return (kept[triangleNumber >> 3] >> (4u * (triangleNumber & 7u))) & 7u;
}

void main()
{
    ConservativeTriangle t;
    t.edge0 = edge0;
    t.edge1 = edge1;
    t.edge2 = edge2;
    t.plane = plane;
    t.rect = rect;
    t.range = range;
    vec2 c = gl_FragCoord.xy - texelBase(rect);
    bool drawn = all(lessThan(gl_FragCoord.xy, rect.zw));
    float depth;
    if (LAYER == LAYER_NEAR) {
        drawn = drawn && touches(t, c);
        depth = nearDepth(caster, t, c);
    } else if (LAYER == LAYER_FAR) {
        drawn = drawn && covers(t, c);
        depth = farDepth(caster, t, c);
    } else if (LAYER == LAYER_SLOPE) {
        drawn = drawn && touches(t, c);
        depth = t.range.w != 0.0 ? 0.0 : slopeAsDepth(t.range.z);
    } else if (LAYER == LAYER_CENTRE) {
        drawn = drawn && holds(t, c);
        depth = clamp(depthAt(t, c), t.range.x, t.range.y);
    } else {
        drawn = drawn && (LAYER == LAYER_THESIS_NEAR ? thesisTouches(t, c, caster.flags)
                                                     : thesisCovers(t, c, keptEdges(), caster.flags));
        depth = depthAt(t, c);
    }
    // Depth 1 means that nothing is there.
    if (!drawn || !(depth < 1.0)) discard;
    gl_FragDepth = max(depth, 0.0);
}
