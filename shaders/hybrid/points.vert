#version 460
// One point a pixel of a list, on the pixel's centre.
#extension GL_GOOGLE_include_directive : require
#include "ray_list.h"

layout(set = 0, binding = 5, std430) readonly buffer List {
    uint pixels[];
};
layout(push_constant) uniform Push {
    vec4 area; // pixels: x, y, width, height
    float value;
};
layout(location = 0) flat out float shown;

void main()
{
    uint pixel = pixels[gl_VertexIndex];
    vec2 centre = vec2(pixelX(pixel), pixelY(pixel)) + 0.5;
    gl_Position = vec4(2.0 * (centre - area.xy) / area.zw - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
    shown = value;
}
