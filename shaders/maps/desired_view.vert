#version 460
// Casters into the cropped map.
#extension GL_GOOGLE_include_directive : require
#include "../shared/caster_clip.glsl"
#include "desired_view.h"

layout(set = 0, binding = 0, std140) uniform Constants { DesiredViewConstants desired; };
layout(set = 0, binding = 1, std430) readonly buffer View { DesiredView view; };

void main()
{
    vec4 clip = casterClip();
    // The crop in clip space: texel = side / 2 (x / w + 1).
    vec2 moved = view.crop.xy - 1.0 + view.crop.zw * (2.0 / desired.base.map.side);
    clip.xy = clip.xy * view.crop.xy + moved * clip.w;
    gl_Position = clip;
}
