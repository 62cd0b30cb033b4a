#version 460
// Averages what pixels of one surface see, as far apart as the penumbra is wide and rays are few.
#extension GL_GOOGLE_include_directive : require
#include "ray_soft.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RaySoftConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2D seenImage; // history, what a first pass made of it, or what rays found
layout(set = 0, binding = 5) uniform sampler2D tileImage;
// x, y, z: as of history, z on average; w: how many independent pixels the mean is of. The last pass writes visibility.
layout(location = 0) out vec4 seen;
layout(constant_id = 0) const bool HAS_NORMALS = true;
layout(constant_id = 1) const bool IS_LAST = false;

#include "../shared/soft_surface.glsl"

const int TAPS = 12;
// Radius over the geometric mean of half the penumbra's width and of a pixel. The blur itself is off by the square of radius
// over width, the noise of squarePoint()'s lattice by that of a pixel over the radius: both are least together there. Of
// simulated edges, half as wide as 1 to 16 pixels, 1.3 to 1.6 are the best factors. With more rays it shrinks with their cube
// root: what is left of noise after some frames is less than the blur.
const float REACH = 1.5;
const float MOST_PIXELS = 32.0; // of the radius: what a frame can look up without leaving its caches
const float GOLDEN_ANGLE = 2.3999632;

// Half the penumbra's width around a pixel that met no blocker itself, from tiles up to a tile away; 0: all of them see the
// light, or all do not.
float widthAround(ivec2 pixel)
{
    ivec2 tile = pixel / SOFT_TILE, last = textureSize(tileImage, 0) - 1;
    float least = 1.0, most = 0.0, sum = 0.0, count = 0.0;
    for (int i = 0; i < 9; ++i) {
        vec4 found = texelFetch(tileImage, clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last), 0);
        least = min(least, found.x);
        most = max(most, found.y);
        if (!(found.z > 0.0)) continue;
        sum += found.z;
        count += 1.0;
    }
    return least < most && count > 0.0 ? sum / count : 0.0;
}

// What the rays of a pixel count: all the same, or by how much they light it.
float weightOf(vec4 found) { return (constants.state.x & SOFT_WEIGHTED) != 0u ? found.z : 1.0; }

// Mean of taps on the surface's own plane, in a spiral (H. Vogel 1979) that each pixel turns by an angle of its own; the mean of
// their z; and of how many it is, were they of one weight. With weights, sums of light that arrives are divided by sums of light
// that would: the ratio of E. Heitz, S. Hill and M. McGuire, "Combining analytic direct illumination and stochastic shadows"
// (I3D 2018).
// halfWidth: of the penumbra, metres; rays: that the pixel has asked
vec3 blurred(ivec2 pixel, vec4 own, float halfWidth, float rays)
{
    Surface surface = surfaceAt(constants.base.view, constants.base.area, pixel);
    vec3 n = surface.normalWs;
    vec3 across = abs(n.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    vec3 x = normalize(cross(n, across)), y = cross(n, x);
    float radius = REACH * sqrt(halfWidth * surface.pixelWs) * pow(rays, -1.0 / 3.0);
    radius = min(radius, MOST_PIXELS * surface.pixelWs);
    if (!(radius > 0.5 * surface.pixelWs)) return vec3(own.xz, 1.0); // every tap is the pixel itself
    uvec2 turn = uvec2(pixel) * uvec2(0xdb4f0b91u, 0xbbe05633u); // as squarePoint() of ray_soft_trace.frag
    float angle = float((turn.x + turn.y) >> 8) * (6.2831853 / 16777216.0) + (IS_LAST ? 0.5 * GOLDEN_ANGLE : 0.0);
    float ownWeight = weightOf(own);
    float sum = ownWeight * own.x, weights = ownWeight, squares = ownWeight * ownWeight, frames = own.z, taps = 1.0;
    for (int i = 0; i < TAPS; ++i) {
        float out_ = sqrt((float(i) + 0.5) / float(TAPS));
        vec2 at = out_ * radius * vec2(cos(angle + float(i) * GOLDEN_ANGLE), sin(angle + float(i) * GOLDEN_ANGLE));
        vec2 drawn = drawnAt(constants.base.view, constants.base.area, surface.atWs + at.x * x + at.y * y);
        if (!isInside(constants.base.area, drawn)) continue;
        vec4 tap = texelFetch(seenImage, ivec2(drawn), 0);
        if (!(tap.y >= 0.0)) continue; // not asked
        float weight = exp(-1.5 * out_ * out_) * likeness(constants.base.view, surface, ivec2(drawn), radius);
        if (!(weight > 0.0)) continue; // nor is a number
        taps += weight;
        frames += weight * tap.z;
        weight *= weightOf(tap);
        sum += weight * tap.x;
        weights += weight;
        squares += weight * weight;
    }
    if (!(weights > 0.0)) return vec3(own.xz, 1.0);
    return vec3(sum / weights, frames / taps, weights * weights / squares);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 own = texelFetch(seenImage, pixel, 0);
    seen = vec4(own.xyz, 1.0);
    if (!(own.y >= 0.0)) return;
    float around = widthAround(pixel);
    if (!(around > 0.0)) return;
    float rays = max(own.z * float(clamp(constants.state.y, 1u, SOFT_RAYS)), 1.0);
    seen.xzw = blurred(pixel, own, own.y > 0.0 ? own.y : around, rays);
}
