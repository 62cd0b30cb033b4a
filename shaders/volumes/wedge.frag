#version 460
#extension GL_GOOGLE_include_directive : require
// What one edge adds to the coverage of the light at a receiver; and DOUBT where that may be off by a whole disc.
// Blended as colour + what is there * alpha.
//
// The receiver is where the count is asked for, lifted off its surface (receiver_tile.h): at a grazing view the other
// end of that way may lie across the edge's plane, and count and share would be off by a disc.
#include "wedge.h"

layout(set = 0, binding = 4, std140) uniform Receivers { WedgeConstants wedges; };
layout(set = 0, binding = 5, std430) readonly buffer Depths { float depths[]; }; // lifted
layout(location = 0) flat in vec3 fromEs;
layout(location = 1) flat in vec3 toEs;
layout(location = 0) out vec4 coverage;

void main()
{
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    float depth = depths[pixel.y * wedges.depthColumns + pixel.x];
    float w = linearDepth(wedges.view, depth);
    vec3 ray = receiverRayWs(wedges.view, viewRayWs(wedges.view, gl_FragCoord.xy), depth);
    vec3 receiver = w * ray;
    EdgeShare edge = edgeShare(fromEs - receiver, toEs - receiver, wedges.lightEs.xyz - receiver, wedges.lightEs.w);
    // What rasteriser and float may disagree by: a 64th of a pixel, two units of depth, twice the rounding of coordinates.
    vec3 largest = max(abs(receiver), abs(wedges.lightEs.xyz));
    float doubt = w * wedges.view.pixelSize / 64.0 + 2.0 * depthUlpWs(wedges.view, depth, ray) +
                  max(largest.x, max(largest.y, largest.z)) * (1.0 / 1048576.0);
    coverage = vec4(edge.share + (edge.clearance < doubt ? DOUBT : 0.0), 0.0, 0.0, 1.0);
}
