#version 460
// Texels that a sheet of faces covers, with the largest depth it can have there, into the under-estimated layer: texels that
// no border of a sheet touches, so that the sheet over the centre goes on to all sides.
#extension GL_GOOGLE_include_directive : require
#include "conservative.h"

layout(set = 0, binding = 1) uniform sampler2D slopes;  // LAYER_SLOPE of faces, and their borders
layout(set = 0, binding = 2) uniform sampler2D centres; // LAYER_CENTRE
layout(push_constant, std430) uniform Push { SheetErrors errors; };

void main()
{
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float slope = texelFetch(slopes, texel, 0).x;
    float centre = texelFetch(centres, texel, 0).x;
    bool sheet = slope > 0.0 && slope < 1.0 && centre < 1.0;
    float depth = sheetDepth(errors, centre, slopeOfDepth(max(slope, 1e-30)));
    if (!sheet || !(depth < 1.0)) discard;
    gl_FragDepth = max(depth, 0.0);
}
