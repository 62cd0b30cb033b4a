#version 450
// A host's own look-ups: of one light at any points. sampled.hlsl says the same in HLSL.
#extension GL_GOOGLE_include_directive : require
#define GNOMON_SHADOW_SET 0
#define GNOMON_SHADOW_BINDING 0
#define GNOMON_SHADOW_MAPS_BINDING 1
#define GNOMON_SHADOW_SAMPLER_BINDING 2
#define GNOMON_SHADOW_LIGHTS 3
#ifdef GNOMON_SHADOW_SOFT
uint pixel;
#define GNOMON_SHADOW_PIXEL (vec2(pixel % 160u, pixel / 160u) + 0.5)
#endif
#include "gnomon/sample_shadow.h"
#if defined(GNOMON_SHADOW_REVECTORIZED)
#define SAMPLE gn_sampleShadowRevectorized
#elif defined(GNOMON_SHADOW_SOFT)
#define SAMPLE gn_sampleShadowSoft
#elif defined(GNOMON_SHADOW_MOMENTS)
#define SAMPLE gn_sampleShadowMoments
#else
#define SAMPLE gn_sampleShadow
#endif

layout(local_size_x = 64) in;
layout(set = 0, binding = 3, std140) uniform Question {
    uint light;
    uint count;
};
layout(set = 0, binding = 4, std430) buffer Points { vec4 points[]; }; // position, normal; the answer goes to w

void main()
{
    uint i = gl_GlobalInvocationID.x;
#ifdef GNOMON_SHADOW_SOFT
    pixel = i;
#endif
    if (i < count) points[2 * i].w = SAMPLE(light, points[2 * i].xyz, points[2 * i + 1].xyz);
}
