// Shadows looked up in a host's own shader, for what is not in its depth: glass, particles, forward renderers. GLSL,
// HLSL and Slang read this file. Say where the three bindings are, and for how many lights: GnViewFrame::lightCount at
// least.
//
//     #define GNOMON_SHADOW_SET 1
//     #define GNOMON_SHADOW_BINDING 0         // uniform buffer: GnSampledShadows::pConstants
//     #define GNOMON_SHADOW_MAPS_BINDING 1    // GNOMON_SHADOW_LIGHTS sampled images: pMaps
//     #define GNOMON_SHADOW_SAMPLER_BINDING 2 // sampler
//     #define GNOMON_SHADOW_LIGHTS 4
//     #include "gnomon/sample_shadow.h"
//     ...
//     float lit = gn_sampleShadow(i, position, normal); // 1 lit, 0 umbra, for GnViewFrame::pLights[i]
//
// HLSL for glslang's front end: define GNOMON_HLSL first. Up to eight lights need nothing of the device. For more of
// them define GNOMON_SHADOW_INDEXED, and enable shaderSampledImageArrayDynamicIndexing; where the index differs among
// the pixels of a draw, define GNOMON_SHADOW_NONUNIFORM instead (shaderSampledImageArrayNonUniformIndexing; in GLSL
// GL_EXT_nonuniform_qualifier).
#ifndef GNOMON_SAMPLE_SHADOW_H
#define GNOMON_SAMPLE_SHADOW_H

#if !defined(GNOMON_HLSL) && (defined(__HLSL_VERSION) || defined(__SLANG__))
#define GNOMON_HLSL
#endif
#ifndef GNOMON_SHADOW_SET
#define GNOMON_SHADOW_SET 0
#endif
#ifndef GNOMON_SHADOW_BINDING
#define GNOMON_SHADOW_BINDING 0
#endif
#ifndef GNOMON_SHADOW_MAPS_BINDING
#define GNOMON_SHADOW_MAPS_BINDING 1
#endif
#ifndef GNOMON_SHADOW_SAMPLER_BINDING
#define GNOMON_SHADOW_SAMPLER_BINDING 2
#endif
#ifndef GNOMON_SHADOW_LIGHTS
#define GNOMON_SHADOW_LIGHTS 1
#endif

#include "../shared/shadow_sample.h"

#ifdef GNOMON_HLSL
[[vk::binding(GNOMON_SHADOW_BINDING, GNOMON_SHADOW_SET)]] cbuffer GnomonShadows
{
    ShadowSample gnomonShadows[GNOMON_SHADOW_LIGHTS];
};
[[vk::binding(GNOMON_SHADOW_MAPS_BINDING, GNOMON_SHADOW_SET)]]
Texture2DArray<float> gnomonShadowMaps[GNOMON_SHADOW_LIGHTS];
[[vk::binding(GNOMON_SHADOW_SAMPLER_BINDING, GNOMON_SHADOW_SET)]] SamplerState gnomonShadowSampler;
static uint gnomonShadowLight; // whose map is looked up
#define GNOMON_SHADOW_TEXEL(index, at) gnomonShadowMaps[index].SampleLevel(gnomonShadowSampler, at, 0.0).x
#define GNOMON_SHADOW_GATHER(index, at) gnomonShadowMaps[index].Gather(gnomonShadowSampler, at)
#define nonuniformEXT NonUniformResourceIndex
#else
layout(set = GNOMON_SHADOW_SET, binding = GNOMON_SHADOW_BINDING, std140) uniform GnomonShadows {
    ShadowSample gnomonShadows[GNOMON_SHADOW_LIGHTS];
};
layout(set = GNOMON_SHADOW_SET, binding = GNOMON_SHADOW_MAPS_BINDING) uniform texture2DArray
    gnomonShadowMaps[GNOMON_SHADOW_LIGHTS];
layout(set = GNOMON_SHADOW_SET, binding = GNOMON_SHADOW_SAMPLER_BINDING) uniform sampler gnomonShadowSampler;
uint gnomonShadowLight; // whose map is looked up
#define GNOMON_SHADOW_IMAGE(index) sampler2DArray(gnomonShadowMaps[index], gnomonShadowSampler)
#define GNOMON_SHADOW_TEXEL(index, at) textureLod(GNOMON_SHADOW_IMAGE(index), at, 0.0).x
#define GNOMON_SHADOW_GATHER(index, at) textureGather(GNOMON_SHADOW_IMAGE(index), at)
#endif

#if defined(GNOMON_SHADOW_NONUNIFORM)
#define MAP_TEXEL(at, layer) GNOMON_SHADOW_TEXEL(nonuniformEXT(gnomonShadowLight), vec3(at, layer))
#define MAP_GATHER(at, layer) GNOMON_SHADOW_GATHER(nonuniformEXT(gnomonShadowLight), vec3(at, layer))
#elif defined(GNOMON_SHADOW_INDEXED)
#define MAP_TEXEL(at, layer) GNOMON_SHADOW_TEXEL(gnomonShadowLight, vec3(at, layer))
#define MAP_GATHER(at, layer) GNOMON_SHADOW_GATHER(gnomonShadowLight, vec3(at, layer))
#elif GNOMON_SHADOW_LIGHTS > 8
#error "more than 8 lights: define GNOMON_SHADOW_INDEXED or GNOMON_SHADOW_NONUNIFORM"
#else
#define GNOMON_SHADOW_PICK(i, READ) \
    if (i < GNOMON_SHADOW_LIGHTS && gnomonShadowLight == uint(i)) return READ((i < GNOMON_SHADOW_LIGHTS ? i : 0), at);
#define GNOMON_SHADOW_PICK_ALL(READ) \
    GNOMON_SHADOW_PICK(0, READ) \
    GNOMON_SHADOW_PICK(1, READ) \
    GNOMON_SHADOW_PICK(2, READ) \
    GNOMON_SHADOW_PICK(3, READ) \
    GNOMON_SHADOW_PICK(4, READ) \
    GNOMON_SHADOW_PICK(5, READ) \
    GNOMON_SHADOW_PICK(6, READ) \
    GNOMON_SHADOW_PICK(7, READ)
float gnomonShadowTexel(vec3 at)
{
    GNOMON_SHADOW_PICK_ALL(GNOMON_SHADOW_TEXEL)
    return 1.0;
}
vec4 gnomonShadowGather(vec3 at)
{
    GNOMON_SHADOW_PICK_ALL(GNOMON_SHADOW_GATHER)
    return vec4(1.0, 1.0, 1.0, 1.0);
}
#define MAP_TEXEL(at, layer) gnomonShadowTexel(vec3(at, layer))
#define MAP_GATHER(at, layer) gnomonShadowGather(vec3(at, layer))
#endif
#define NO_DISC_KERNEL
#define CASCADE_PART(i) gnomonShadows[gnomonShadowLight].parts[i]

#include "../shared/cube_tap.glsl"
#include "../shared/filter.glsl"
#include "../shared/kernels.glsl"
#include "../maps/cascade_tap.glsl"
#include "../shared/paraboloid_tap.glsl"

// Visibility in [0, 1]: 1 also where the light does not reach, or has no map; 0 also where the normal faces away.
//   light     index into the view's pLights
//   position  metres, in the coordinates that pOrigin of gnGetSampledShadows() is the zero of
//   normal    unit, geometric; turn it to the light where both sides are lit. (0, 0, 0): of no surface, as of smoke
float gn_sampleShadow(uint light, vec3 position, vec3 normal)
{
    if (light >= uint(GNOMON_SHADOW_LIGHTS)) return 1.0;
    gnomonShadowLight = light;
    uint kind = gnomonShadows[light].kind;
    if (kind == SAMPLE_NOTHING) return 1.0;
    MapLookup look = gnomonShadows[light].map;
    vec4 ahead = gnomonShadows[light].ahead;

    PlaneReceiver r;
    r.depth = 0.0;
    r.ray = position - gnomonShadows[light].eye.xyz;
    r.w = max(dot(ahead.xyz, r.ray) + ahead.w, 0.0);
    r.fromLight = look.eyeFromLight.xyz + r.ray;
    vec3 away = r.fromLight * look.positional + look.axisWs.xyz;
    r.normalWs = dot(normal, normal) > 0.0 ? normal : away * (-1.0 / max(length(away), 1e-20));
    r.offset = r.facing = r.visibility = 0.0;
    r.decided = false;
    r = seenByLight(look, r, true);
    if (r.decided) return r.visibility;

    if (kind == SAMPLE_DISCS) {
        uint layer = dot(r.fromLight, gnomonShadows[light].parts[8].xyz) >= 0.0 ? 0u : 1u;
        Paraboloid part;
        part.rightWs = gnomonShadows[light].parts[4u * layer];
        part.downWs = gnomonShadows[light].parts[4u * layer + 1u];
        part.axisWs = gnomonShadows[light].parts[4u * layer + 2u];
        part.poleWs = gnomonShadows[light].parts[4u * layer + 3u];
        DiscTap disc = discTap(look, part, r, float(layer));
        return look.filterSide > 1.0 ? boxVisibility(disc, disc.at, look.filterSide) : nearestVisibility(disc, disc.at);
    }
    Tap tap;
    if (kind == SAMPLE_CUBE) {
        uint face = cubeFaceOf(r.fromLight);
        tap = faceTap(look, r, cubeClip(look, r.fromLight, face), face);
    } else {
        vec4 clip = look.clipOfEye + GN_MUL(look.clipFromRay, vec4(r.ray, 0.0));
        uint count = gnomonShadows[light].count;
        float lastLayer = gnomonShadows[light].lastLayer, border = gnomonShadows[light].border;
        tap = matrixTap(look, r, clip);
        if (kind == SAMPLE_PARTS) {
            CascadeTaps taps = cascadeTaps(look, r, clip, count, lastLayer, border);
            tap = taps.fine;
            if (taps.coarseShare > 0.0 && look.filterSide > 1.0) {
                float coarse = kernelVisibility(taps.coarse, taps.coarse.at, look.filterSide, look.kernel);
                float fine = kernelVisibility(tap, tap.at, look.filterSide, look.kernel);
                return fine + taps.coarseShare * (coarse - fine);
            }
        }
    }
    return look.filterSide > 1.0 ? kernelVisibility(tap, tap.at, look.filterSide, look.kernel)
                                 : nearestVisibility(tap, tap.at);
}
#endif
