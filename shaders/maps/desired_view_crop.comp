#version 460
// The crop of what is seen.
#extension GL_GOOGLE_include_directive : require
#include "desired_view.h"

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std140) uniform Constants { DesiredViewConstants desired; };
layout(set = 0, binding = 1, std430) buffer View { DesiredView view; };

void main()
{
    vec4 greatest = uintBitsToFloat(view.seen);
    float side = desired.base.map.side;
    vec2 x = cropAxis(1.0 - greatest.x, greatest.z, side, desired.border);
    vec2 y = cropAxis(1.0 - greatest.y, greatest.w, side, desired.border);
    view.crop = vec4(x.x, y.x, x.y, y.y);
}
