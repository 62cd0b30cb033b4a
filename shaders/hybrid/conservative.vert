#version 460
// One triangle over the texels that a caster's triangle may touch, pulled by its number. Three corners over twice the
// rectangle, not six over it: corners cost more than the texels past the diagonal, which the fragment shader drops.
#extension GL_GOOGLE_include_directive : require
#include "conservative.h"

layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Indices { uint indices[]; };
layout(push_constant, std430) uniform Push { ConservativePush caster; };

#include "conservative_varyings.glsl"

layout(constant_id = 0) const uint LAYER = LAYER_NEAR;

vec3 cornerOf(uint index)
{
    uint vertex = 3u * indices[index];
    return vec3(positions[vertex], positions[vertex + 1u], positions[vertex + 2u]);
}

// A triangle narrower than a texel covers none.
bool coversNothing(ConservativeTriangle t) { return t.range.w != 0.0 || min(t.rect.z - t.rect.x, t.rect.w - t.rect.y) < 1.5; }

void main()
{
    uint first = uint(gl_VertexIndex) / 3u * 3u;
    ConservativeTriangle t =
        conservativeTriangle(caster, cornerOf(first), cornerOf(first + 1u), cornerOf(first + 2u));
    edge0 = t.edge0;
    edge1 = t.edge1;
    edge2 = t.edge2;
    plane = t.plane;
    rect = t.rect;
    range = t.range;
    triangleNumber = first / 3u;
    vec2 corner = vec2((gl_VertexIndex - int(first)) == 1 ? 2.0 : 0.0, (gl_VertexIndex - int(first)) == 2 ? 2.0 : 0.0);
    vec2 at = mix(t.rect.xy, t.rect.zw, corner);
    bool nothing = LAYER == LAYER_FAR && coversNothing(t);
    // The empty rectangle is one point, which every rasteriser drops.
    gl_Position = nothing ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(at / caster.side * 2.0 - 1.0, 0.0, 1.0);
}
