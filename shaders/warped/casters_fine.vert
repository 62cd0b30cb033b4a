#version 460
// Casters of triangles so small that a warp leaves them straight: their corners are warped, and rasterised as they are.
#extension GL_GOOGLE_include_directive : require
#include "../shared/caster_clip.glsl"
#include "warped.glsl"

void main()
{
    vec4 clip = casterClip();
    vec2 at = clip.xy / clip.w * 0.5 + 0.5; // w is above zero: they lie before the light
    vec2 inside = clamp(at, 0.0, 1.0);
    vec2 to = warped(inside) + (at - inside);
    gl_Position = vec4((to * 2.0 - 1.0) * clip.w, clip.zw);
}
