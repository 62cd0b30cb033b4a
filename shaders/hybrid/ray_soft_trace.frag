#version 460
// Rays to a few points of the light's source: a disc, or a rectangle.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "ray_soft.h"
#include "../shared/device_rays.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RaySoftConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform accelerationStructureEXT topLevel;
layout(set = 0, binding = 5, std430) readonly buffer Traced {
    TracedCaster traced[];
};
// x: share of the rays that arrive; y: half the penumbra's width, NOT_ASKED where nothing was asked; z: weight of a ray
layout(location = 0) out vec4 seen;
layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "asked_ray.glsl"
#include "disc_axes.glsl"
#include "../shared/soft_surface.glsl"

const float NOT_ASKED = -1.0; // of seen.y; 0: nothing blocks a ray
// Of a ray, over the average: a receiver that touches the light sees a point of it brighter than a half float can tell.
const float MOST_WEIGHT = 1000.0;

// A point of the unit square. Roberts' sequences, "The unreasonable effectiveness of quasirandom sequences" (2018): over the
// image the lattice of four dimensions, so that any few pixels side by side take points well apart; from number to number the
// sequence of two, so that those of one pixel are. Of half discs the mean over 5x5 pixels is off by 0.048, with independent
// points by 0.085.
vec2 squarePoint(ivec2 pixel, uint number)
{
    uvec2 at = uint(pixel.x) * uvec2(0xdb4f0b91u, 0xa0f2ec76u) + uint(pixel.y) * uvec2(0xbbe05633u, 0x89e18285u) +
               number * uvec2(0xc13fa9a9u, 0x91e10da6u);
    return vec2(at >> 8) * (1.0 / 16777216.0);
}

// Half the width of the penumbra of what blocks a ray at `at`, on a plane across the ray: similar triangles from the light's
// disc over the blocker's edge.
float halfPenumbra(LightRay ray, float at, float radius)
{
    bool directional = constants.base.light.type == LIGHT_DIRECTIONAL;
    return directional ? radius * at * length(ray.along) : radius * at / max(1.0 - at, 1e-3);
}

// Of the light's surface: half axes as a receiver sees them, and the way that it faces.
struct Source {
    vec3 x, y, axis;
    bool isDisc;
};

Source sourceSeen(vec3 towardsLight)
{
    if (constants.sourceX.xyz != vec3(0.0))
        return Source(constants.sourceX.xyz, constants.sourceY.xyz, constants.base.light.directionWs.xyz,
                      constants.sourceX.w > 0.0);
    mat2x3 axes = discAxes(towardsLight, constants.disc.x);
    return Source(axes[0], axes[1], towardsLight / max(length(towardsLight), 1e-30), true);
}

// What an element of the surface at the end of `way` sends to a diffuse receiver, but for factors that are the same for
// all of them: cosines at both ends over the squared distance.
float shineOf(Source source, vec3 way, vec3 normalWs)
{
    float squared = max(dot(way, way), 1e-30);
    return max(dot(normalWs, way), 0.0) * abs(dot(source.axis, way)) / (squared * squared);
}

// shineOf() over the surface, on average: by Gauss's rule of 2 x 2 points of a rectangle, and of a disc near it. Only
// ratios matter: it makes a ray count about one.
float meanShine(Source source, vec3 towardsLight, vec3 normalWs)
{
    float at = source.isDisc ? 0.5 : 0.57735;
    vec3 a = at * (source.x + source.y), b = at * (source.x - source.y);
    return 0.25 * (shineOf(source, towardsLight + a, normalWs) + shineOf(source, towardsLight - a, normalWs) +
                   shineOf(source, towardsLight + b, normalWs) + shineOf(source, towardsLight - b, normalWs));
}

vec2 sourcePoint(Source source, vec2 square)
{
    float angle = 6.2831853 * square.y;
    return source.isDisc ? sqrt(square.x) * vec2(cos(angle), sin(angle)) : 2.0 * square - 1.0;
}

// `seen` by rays from a receiver with this normal.
vec3 traceSource(ivec2 pixel, LightRay centre, vec3 normalWs)
{
    Source source = sourceSeen(centre.along);
    bool isWeighted = (constants.state.x & SOFT_WEIGHTED) != 0u;
    float usual = isWeighted ? max(meanShine(source, centre.along, normalWs), 1e-30) : 1.0;
    uint rays = clamp(uint(constants.disc.z), 1u, SOFT_RAYS);
    float arrived = 0.0, asked = 0.0, blocked = 0.0, width = 0.0;
    for (uint i = 0u; i < SOFT_RAYS; ++i) {
        if (i >= rays) break;
        vec2 point = sourcePoint(source, squarePoint(pixel, constants.state.z + i));
        LightRay ray = LightRay(centre.start, centre.along + point.x * source.x + point.y * source.y, centre.end);
        float weight = isWeighted ? min(shineOf(source, ray.along, normalWs) / usual, MOST_WEIGHT) : 1.0;
        if (weight == 0.0) continue;
        float at = blockedAt(ray, constants.base.lightMask.x);
        asked += weight;
        if (at < 0.0) {
            arrived += weight;
        } else {
            blocked += 1.0;
            width += halfPenumbra(centre, at, constants.disc.x);
        }
    }
    return vec3(arrived / max(asked, 1e-30), blocked > 0.0 ? clamp(width / blocked, 1e-5, 60000.0) : 0.0,
                asked / float(clamp(constants.state.y, 1u, SOFT_RAYS)));
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    LightRay ray;
    uint asked = askedAt(constants.base.view, constants.base.light, constants.base.area, pixel,
                         texelFetch(depthImage, pixel, 0).x, ray);
    seen = vec4(asked == ASKED_DARK ? 0.0 : 1.0, NOT_ASKED, 0.0, 0.0);
    if (asked != ASKED_RAY) return;
    vec3 normalWs = surfaceAt(constants.base.view, constants.base.area, pixel).normalWs;
    seen.xyz = traceSource(pixel, ray, normalWs);
}
