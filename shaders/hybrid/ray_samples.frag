#version 460
// Many rays a pixel to points of the light's source, with the points of algorithms/hybrid/ray_traced.cpp.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "ray_samples.h"
#include "../shared/device_rays.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RaySamplesConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform accelerationStructureEXT topLevel;
layout(set = 0, binding = 5, std430) readonly buffer Traced {
    TracedCaster traced[];
};
layout(location = 0) out float visibility;
layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "asked_ray.glsl"
#include "disc_axes.glsl"

// Numbers of 64 bits; x: the lower 32.
uvec2 sum(uvec2 a, uvec2 b)
{
    uint carry;
    uint low = uaddCarry(a.x, b.x, carry);
    return uvec2(low, a.y + b.y + carry);
}

uvec2 product(uvec2 a, uvec2 b)
{
    uint high, low;
    umulExtended(a.x, b.x, high, low);
    return uvec2(low, high + a.x * b.y + a.y * b.x);
}

// a ^ (a >> bits), of 1 to 31 bits.
uvec2 folded(uvec2 a, int bits)
{
    return a ^ uvec2(a.x >> bits | a.y << (32 - bits), a.y >> bits);
}

// mixed() of runtime/base/hash.hpp.
uvec2 mixedWith(uvec2 hash, uint value)
{
    hash = sum(sum(hash, uvec2(value, 0u)), uvec2(0x7f4a7c15u, 0x9e3779b9u));
    hash = product(folded(hash, 30), uvec2(0x1ce4e5b9u, 0xbf58476du));
    hash = product(folded(hash, 27), uvec2(0x133111ebu, 0x94d049bbu));
    return folded(hash, 31);
}

// In [0, 1).
float unitOf(uvec2 hash) { return float(hash.y >> 8) * (1.0 / 16777216.0); }

// discOfSquare() of algorithms/shared/source_points.cpp.
vec2 discOfSquare(vec2 square)
{
    if (square == vec2(0.0)) return square;
    const float EIGHTH = 0.78539816; // of a turn
    bool wide = abs(square.x) > abs(square.y);
    float radius = wide ? square.x : square.y;
    float angle = wide ? EIGHTH * square.y / square.x : EIGHTH * (2.0 - square.x / square.y);
    return radius * vec2(cos(angle), sin(angle));
}

// Half axes of the source as this pixel takes them.
mat2x3 sourceOf(vec3 towardsLight, uvec2 key)
{
    mat2x3 source = constants.sourceX.xyz != vec3(0.0) ? mat2x3(constants.sourceX.xyz, constants.sourceY.xyz)
                                                       : discAxes(towardsLight, constants.sourceY.w);
    if (constants.samples.z != 0u) {
        if ((key.x & SAMPLE_SETS) != 0u) source[0] = -source[0];
        if ((key.x & 2u * SAMPLE_SETS) != 0u) source[1] = -source[1];
        return source;
    }
    float angle = 6.2831853 * unitOf(key);
    return mat2x3(cos(angle) * source[0] + sin(angle) * source[1], cos(angle) * source[1] - sin(angle) * source[0]);
}

// The share of the points that are seen, in steps of 255.
uint shareSeen(LightRay centre, ivec2 pixel)
{
    uvec2 place = uvec2(pixel - ivec2(constants.base.area.xy));
    uvec2 key = mixedWith(mixedWith(uvec2(constants.samples.y, 0u), place.y), place.x);
    mat2x3 source = sourceOf(centre.along, key);
    uvec2 set = mixedWith(uvec2(key.x % SAMPLE_SETS, 0u), constants.samples.y);
    uint count = clamp(constants.samples.x, 1u, MOST_SAMPLES), rows = clamp(constants.samples.w, 1u, count);
    uint row = 0u, first = 0u, end = count / rows, seen = 0u;
    for (uint i = 0u; i < MOST_SAMPLES; ++i) {
        if (i >= count) break;
        if (i == end) {
            ++row;
            first = end;
            end = count * (row + 1u) / rows;
        }
        float inRow = float(end - first);
        float u = (float(i - first) + unitOf(mixedWith(set, 2u * i))) / inRow;
        float v = (float(first) + inRow * unitOf(mixedWith(set, 2u * i + 1u))) / float(count);
        vec2 point = 2.0 * vec2(u, v) - 1.0;
        if (constants.samples.z == 0u) point = discOfSquare(point);
        LightRay ray = LightRay(centre.start, centre.along + source * point, centre.end);
        seen += isOccluded(ray, constants.base.lightMask.x) ? 0u : 1u;
    }
    return (510u * seen + count) / (2u * count); // nearest of 255
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    LightRay ray;
    uint asked = askedAt(constants.base.view, constants.base.light, constants.base.area, pixel,
                         texelFetch(depthImage, pixel, 0).x, ray);
    visibility = asked == ASKED_DARK ? 0.0 : 1.0;
    if (asked == ASKED_RAY) visibility = float(shareSeen(ray, pixel)) / 255.0;
}
