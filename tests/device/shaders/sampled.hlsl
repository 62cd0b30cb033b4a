// sampled.comp in HLSL.
#define GNOMON_HLSL
#define GNOMON_SHADOW_SET 0
#define GNOMON_SHADOW_BINDING 0
#define GNOMON_SHADOW_MAPS_BINDING 1
#define GNOMON_SHADOW_SAMPLER_BINDING 2
#define GNOMON_SHADOW_LIGHTS 3
#ifdef GNOMON_SHADOW_SOFT
static uint pixel;
#define GNOMON_SHADOW_PIXEL (float2(pixel % 160u, pixel / 160u) + 0.5)
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

[[vk::binding(3, 0)]] cbuffer Question
{
    uint light;
    uint count;
};
[[vk::binding(4, 0)]] RWStructuredBuffer<float4> points;

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
#ifdef GNOMON_SHADOW_SOFT
    pixel = id.x;
#endif
    if (id.x < count) points[2 * id.x].w = SAMPLE(light, points[2 * id.x].xyz, points[2 * id.x + 1].xyz);
}
