#version 460
// The rectangle of a light's map that the receivers in view lie in. Receivers that no map decides count for nothing.
#extension GL_GOOGLE_include_directive : require
#include "desired_view.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std140) uniform Constants { DesiredViewConstants desired; };
layout(set = 0, binding = 1, std430) buffer View { DesiredView view; };
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;

#include "../shared/map_place.glsl"

const uint TILE = 4u; // pixels per side that an invocation looks at
const uint TILE_PIXELS = TILE * TILE;

shared uint seen[4];

void main()
{
    if (gl_LocalInvocationIndex < 4u) seen[gl_LocalInvocationIndex] = 0u;
    barrier();
    ViewConstants camera = desired.base.view;
    MapLookup look = desired.base.map;
    uvec2 first = gl_GlobalInvocationID.xy * TILE;
    vec4 greatest = vec4(0.0);
    for (uint i = 0u; i < TILE_PIXELS; ++i) {
        uvec2 inside = first + uvec2(i % TILE, i / TILE);
        if (inside.x >= desired.pixels.z || inside.y >= desired.pixels.w) continue;
        ivec2 pixel = ivec2(inside + desired.pixels.xy);
        float depth = texelFetch(depthImage, pixel, 0).x;
        if (depth == camera.skyDepth) continue;
        float w = linearDepth(camera, depth);
        if (!(w > 0.0 && w < 1e30)) continue;
        vec3 ray = viewRayWs(camera, vec2(pixel) + 0.5);
        MapPlace is = mapPlace(look, camera, pixel, depth, w, ray, look.clipFromRay * vec4(ray, 0.0));
        if (is.at.x >= 0.0) greatest = max(greatest, vec4(1.0 - is.at, is.at));
    }
    // Floats of 0 and above are ordered as their bits are.
    for (int i = 0; i < 4; ++i)
        atomicMax(seen[i], floatBitsToUint(greatest[i]));
    barrier();
    uint me = gl_LocalInvocationIndex;
    if (me < 4u && seen[me] != 0u) atomicMax(view.seen[me], seen[me]);
}
