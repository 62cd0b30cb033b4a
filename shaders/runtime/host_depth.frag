#version 460
#extension GL_GOOGLE_include_directive : require
// A view's depth values as methods read them: floats of one sample, of depth planes across the view.
#include "host_image.glsl"

void main()
{
    float depth = hostTexel().x;
    float plane = straight.x + straight.y * gl_FragCoord.x + straight.z * gl_FragCoord.y;
    float straightened = depth == skyDepth ? 0.0 : clamp(straight.w * (depth - plane), 0.0, 1.0);
    gl_FragDepth = way != 0u ? straightened : depth;
}
