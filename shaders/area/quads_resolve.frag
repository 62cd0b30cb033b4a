#version 460
// Visibility: the weights of the points that a pixel sees.
#extension GL_GOOGLE_include_directive : require
#include "quads.h"

layout(set = 0, binding = 0, std140) uniform Constants { PointWeights weights; };
layout(set = 0, binding = 1) uniform usampler2DArray words;
layout(location = 0) out float visibility;

#include "point_words.glsl"

void main()
{
    float seen = 0.0;
    for (uint i = 0u; i < min(weights.count, MAX_POINTS); ++i) { // bound: MAX_POINTS
        uvec2 point = (i & 1u) == 0u ? weights.points[i >> 1].xy : weights.points[i >> 1].zw;
        seen += visibilityOf(pointCode(ivec2(gl_FragCoord.xy), point.x)) * uintBitsToFloat(point.y);
    }
    visibility = weights.shown >= 0.0 ? weights.shown : clamp(seen, 0.0, 1.0);
}
