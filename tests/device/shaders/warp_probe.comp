#version 460
// Where a warp takes places, and where it takes them from.
#extension GL_GOOGLE_include_directive : require
#define PLACES_IN_TABLE
#ifdef RECTILINEAR
#include "warped/rectilinear.glsl"
#else
#include "warped/nonorthogonal_functions.glsl"
#endif

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(std430, set = 0, binding = 1) readonly buffer Places { vec2 asked[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Answers { vec4 answers[]; }; // RECTILINEAR: one a place, else two

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= asked.length()) return;
    uint map = uint(findMSB(warp.maps)); // the last
    float side = warp.base.map.side;
    uvec2 texel = min(uvec2(asked[i] * side), uvec2(side - 1.0));
    vec2 from = placeOf(map, texel, side) / side;
#ifdef RECTILINEAR
    answers[i] = vec4(warped(map, asked[i], side), from);
#else
    answers[2u * i] = vec4(from, vec2(texelOf(map, asked[i], side)));
    answers[2u * i + 1u] = vec4(vec2(texelOf(map, from, side)), 0.0, 0.0);
#endif
}
