#version 460
// Flags the squares of a light's source that show a plateau: a pixel that sees some of the four corners, but not all,
// and pixels on all sides of it that see as many. RAMPS: where enough corners are on ramps, nothing shows.
// Source: Macedo 2018, 6.1; M. Schwarzler, O. Mattausch, D. Scherzer and M. Wimmer, "Fast accurate soft shadows with
// adaptive light source sampling", VMV 2012.
#extension GL_GOOGLE_include_directive : require
#include "quads.h"

layout(local_size_x = 8, local_size_y = 8) in; // QUAD_GROUP

layout(set = 0, binding = 0, std140) uniform Constants { QuadTests tests; };
layout(set = 0, binding = 1) uniform usampler2DArray words;
layout(set = 0, binding = 2, std430) buffer Flags { uint flags[]; };

#include "point_words.glsl"

// Corners that the pixel sees; 4, as of all, where it shows no step.
uint cornersSeen(ivec2 pixel, uvec4 corners)
{
    uint seen = 0u, ramps = 0u;
    for (int i = 0; i < 4; ++i) {
        uint code = pointCode(pixel, corners[i]);
        seen += 2u * code > RAMP_CODES ? 1u : 0u;
        ramps += onRamp(code) ? 1u : 0u;
    }
    return ramps >= tests.ramps ? 4u : seen;
}

void main()
{
    ivec2 size = ivec2(tests.area.zw), inside = ivec2(gl_GlobalInvocationID.xy * tests.window);
    if (inside.x >= size.x || inside.y >= size.y) return;
    ivec2 first = ivec2(tests.area.xy);
    for (uint i = 0u; i < min(tests.count, MAX_QUADS); ++i) { // bound: MAX_QUADS
        uint seen = cornersSeen(first + inside, tests.corners[i]);
        if (seen == 0u || seen == 4u) continue;
        bool level = true;
        for (int side = 0; side < 9; ++side) {
            ivec2 at = inside + int(tests.window) * (ivec2(side % 3, side / 3) - 1);
            at = clamp(at, ivec2(0), size - 1);
            level = level && cornersSeen(first + at, tests.corners[i]) == seen;
        }
        if (level) atomicOr(flags[min(tests.firstFlag + i, uint(flags.length()) - 1u)], 1u);
    }
}
