// Visibility of a point that stands for what of its source is nearer to it than to the next: the edge of a shadow is
// blurred as wide as the gap between the edges that two neighbours cast. The gap follows from the depths of what is
// before the receiver (as Fernando 2005); blurred are lines in place of texels' stairs.
#ifndef GNOMON_AREA_GAP_KERNEL_GLSL
#define GNOMON_AREA_GAP_KERNEL_GLSL
#include "../revectorized/line_kernel.h"

const uint LONGEST_STAIR = 16u; // texels: Macedo 2018, listing A.3
const int SEARCH = 4;           // places a side, of four texels each
const int PLACES = SEARCH * SEARCH;

// What hides the receiver about its place. side: texels that the places are spread over.
struct Blockers {
    float texels;
    float depth; // mean, before the receiver's plane
    bool all;
};

Blockers blockersAbout(Tap tap, float side)
{
    float sum = 0.0, count = 0.0;
    for (int i = 0; i < PLACES; ++i) {
        vec2 place = (vec2(i % SEARCH, i / SEARCH) - 0.5 * float(SEARCH - 1)) * (side / float(SEARCH));
        vec2 corner = floor(tap.at + place + 0.5);
        vec4 receiver = vec4(tapDepth(tap, corner + vec2(-0.5, 0.5)), tapDepth(tap, corner + vec2(0.5, 0.5)),
                             tapDepth(tap, corner + vec2(0.5, -0.5)), tapDepth(tap, corner + vec2(-0.5, -0.5)));
        vec4 before = min(receiver, 1.0) - mapGather(tap, corner);
        vec4 blocks = vec4(greaterThan(before, vec4(0.0)));
        sum += dot(before, blocks);
        count += dot(blocks, vec4(1.0));
    }
    return Blockers(count, sum / max(count, 1.0), count == float(4 * PLACES));
}

// How far a point's edge is from that of its neighbour, texels, where a depth of 1 is between receiver and caster.
vec2 texelsPerDepth(MapLookup look, vec3 gap)
{
    float perDepth = look.positional != 0.0 ? -1.0 / look.depthScale : length(look.axisWs.xyz);
    vec3 dx = look.texelDx.xyz, dy = look.texelDy.xyz;
    return perDepth * vec2(dot(gap, dx) / dot(dx, dx), dot(gap, dy) / dot(dy, dy));
}

// gapX, gapY: to the next points. most: texels a side, odd.
float gapVisibility(Tap tap, MapLookup look, vec3 gapX, vec3 gapY, uint most)
{
    Blockers blockers = blockersAbout(tap, float(most));
    if (blockers.texels == 0.0) return 1.0;
    if (blockers.all) return 0.0;
    vec2 x = texelsPerDepth(look, gapX) * blockers.depth, y = texelsPerDepth(look, gapY) * blockers.depth;
    vec2 along = dot(x, x) >= dot(y, y) ? x : y; // the longer axis of an ellipse
    float longer = length(along), shorter = min(length(x), length(y)), limit = 0.5 * float(most);
    LineKernel kernel = boxKernel(1u);
    float radius = clamp(0.5 * longer, 0.5, limit);
    kernel.radius = clamp(0.5 * shorter, 0.5, limit);
    kernel.squeeze = along * (sqrt(1.0 - kernel.radius / radius) / max(longer, 1e-6));
    kernel.side = 2u * uint(ceil(radius - 0.5)) + 1u;
    return lineKernelVisibility(tap, tap.at, kernel, LONGEST_STAIR);
}
#endif
