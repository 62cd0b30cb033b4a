#version 460
// Rays to a few points of the light's disc.
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
layout(location = 0) out vec2 seen; // x: share of the rays that arrive; y: half the penumbra's width, see asked below
layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "asked_ray.glsl"

const float NOT_ASKED = -1.0; // of seen.y; 0: nothing blocks a ray

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

// LightDisc of algorithms/hybrid/light_disc.hpp.
mat2x3 discAxes(vec3 towardsLight, float radius)
{
    vec3 size = abs(towardsLight);
    vec3 across = size.x <= size.y && size.x <= size.z ? vec3(1.0, 0.0, 0.0)
                  : size.y <= size.z                  ? vec3(0.0, 1.0, 0.0)
                                                      : vec3(0.0, 0.0, 1.0);
    vec3 y = cross(towardsLight, across);
    vec3 x = cross(y, towardsLight);
    return mat2x3(x * (radius / max(length(x), 1e-30)), y * (radius / max(length(y), 1e-30)));
}

// Half the width of the penumbra of what blocks a ray at `at`, on a plane across the ray: similar triangles from the light's
// disc over the blocker's edge.
float halfPenumbra(LightRay ray, float at, float radius)
{
    bool directional = constants.base.light.type == LIGHT_DIRECTIONAL;
    return directional ? radius * at * length(ray.along) : radius * at / max(1.0 - at, 1e-3);
}

vec2 traceDisc(ivec2 pixel, LightRay centre)
{
    float radius = constants.disc.x;
    mat2x3 axes = discAxes(centre.along, radius);
    uint rays = clamp(constants.state.y, 1u, SOFT_RAYS);
    float arrived = 0.0, width = 0.0;
    for (uint i = 0u; i < SOFT_RAYS; ++i) {
        if (i >= rays) break;
        vec2 square = squarePoint(pixel, constants.state.z + i);
        float angle = 6.2831853 * square.y;
        vec2 point = sqrt(square.x) * vec2(cos(angle), sin(angle));
        LightRay ray = LightRay(centre.start, centre.along + axes * point, centre.end);
        float at = blockedAt(ray, constants.base.lightMask.x);
        if (at < 0.0)
            arrived += 1.0;
        else
            width += halfPenumbra(centre, at, radius);
    }
    float blocked = float(rays) - arrived;
    return vec2(arrived / float(rays), blocked > 0.0 ? clamp(width / blocked, 1e-5, 60000.0) : 0.0);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    LightRay ray;
    uint asked = askedAt(constants.base.view, constants.base.light, constants.base.area, pixel,
                         texelFetch(depthImage, pixel, 0).x, ray);
    seen = asked == ASKED_RAY ? traceDisc(pixel, ray) : vec2(asked == ASKED_DARK ? 0.0 : 1.0, NOT_ASKED);
}
