#version 460
// Where a warp takes places, and where it takes them from.
#extension GL_GOOGLE_include_directive : require
#ifdef RECTILINEAR
#include "warped/rectilinear.glsl"
#else
#include "warped/nonorthogonal_functions.glsl"
#endif

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(std430, set = 0, binding = 1) readonly buffer Places { vec2 asked[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Answers { vec4 answers[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= asked.length()) return;
    uint map = uint(findMSB(warp.maps)); // the last
#ifdef RECTILINEAR
    float side = warp.base.map.side;
    vec2 from = placeOf(map, min(uvec2(asked[i] * side), uvec2(side - 1.0)), side) / side;
#else
    vec2 from = unwarped(map, asked[i]);
#endif
    answers[i] = vec4(warped(map, asked[i], warp.base.map.side), from);
}
