#version 460
// The source places of the texels of a non-orthogonal map.
#extension GL_GOOGLE_include_directive : require
#include "nonorthogonal_functions.glsl"

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(push_constant, std430) uniform Push { uint map; };
layout(location = 0) out vec2 place;

void main() { place = unwarped(map, gl_FragCoord.xy / warp.base.map.side) * warp.base.map.side; }
