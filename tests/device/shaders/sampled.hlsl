// sampled.comp in HLSL.
#define GNOMON_HLSL
#define GNOMON_SHADOW_SET 0
#define GNOMON_SHADOW_BINDING 0
#define GNOMON_SHADOW_MAPS_BINDING 1
#define GNOMON_SHADOW_SAMPLER_BINDING 2
#define GNOMON_SHADOW_LIGHTS 3
#include "gnomon/sample_shadow.h"

[[vk::binding(3, 0)]] cbuffer Question
{
    uint light;
    uint count;
};
[[vk::binding(4, 0)]] RWStructuredBuffer<float4> points;

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    if (id.x < count) points[2 * id.x].w = gn_sampleShadow(light, points[2 * id.x].xyz, points[2 * id.x + 1].xyz);
}
