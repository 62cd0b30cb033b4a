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
// Three more functions take the same arguments. They are there where what they need is defined before:
//     #define GNOMON_SHADOW_REVECTORIZED 1 // gn_sampleShadowRevectorized(): `mode` of rbsm, 0 to 2
//     #define GNOMON_SHADOW_SOFT 64        // gn_sampleShadowSoft(): taps of the filter, 128 at most
//     #define GNOMON_SHADOW_PIXEL gl_FragCoord.xy // for it: turns its taps; without, they turn with the place in the map
//
//     #define GNOMON_SHADOW_MOMENTS 3      // gn_sampleShadowMoments(): `kind` of moments, 0 to 4
//     #define GNOMON_SHADOW_MOMENTS_FILTER 5     // its `filter`, 15 at most; without: 5
//     #define GNOMON_SHADOW_MOMENTS_BLEEDING 0.1 // its `bleeding`; without: 0.1
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

// A place as the light's map sees it; decided where there is nothing to look up.
PlaneReceiver gnomonShadowReceiver(uint light, vec3 position, vec3 normal)
{
    PlaneReceiver r;
    r.fromLight = r.normalWs = r.ray = vec3(0.0, 0.0, 0.0);
    r.w = r.depth = r.offset = r.facing = 0.0;
    r.visibility = 1.0;
    r.decided = true;
    if (light >= uint(GNOMON_SHADOW_LIGHTS)) return r;
    gnomonShadowLight = light;
    if (gnomonShadows[light].kind == SAMPLE_NOTHING) return r;
    MapLookup look = gnomonShadows[light].map;
    vec4 ahead = gnomonShadows[light].ahead;
    r.ray = position - gnomonShadows[light].eye.xyz;
    r.w = max(dot(ahead.xyz, r.ray) + ahead.w, 0.0);
    r.fromLight = look.eyeFromLight.xyz + r.ray;
    vec3 away = r.fromLight * look.positional + look.axisWs.xyz;
    r.normalWs = dot(normal, normal) > 0.0 ? normal : away * (-1.0 / max(length(away), 1e-20));
    return seenByLight(look, r, true);
}

// Where it is in a map of matrices: the finest part, and the next. clip: in the clip space of the first.
CascadeTaps gnomonShadowTaps(MapLookup look, PlaneReceiver r, out vec4 clip)
{
    uint kind = gnomonShadows[gnomonShadowLight].kind;
    uint face = cubeFaceOf(r.fromLight);
    if (kind == SAMPLE_CUBE) clip = cubeClip(look, r.fromLight, face);
    else clip = look.clipOfEye + GN_MUL(look.clipFromRay, vec4(r.ray, 0.0));
    if (kind == SAMPLE_PARTS)
        return cascadeTaps(look, r, clip, gnomonShadows[gnomonShadowLight].count,
                           gnomonShadows[gnomonShadowLight].lastLayer, gnomonShadows[gnomonShadowLight].border);
    CascadeTaps taps;
    if (kind == SAMPLE_CUBE) taps.fine = faceTap(look, r, clip, face);
    else taps.fine = matrixTap(look, r, clip);
    taps.coarse = taps.fine;
    taps.coarseShare = 0.0;
    return taps;
}

// In one or two paraboloids.
float gnomonShadowDisc(MapLookup look, PlaneReceiver r)
{
    uint light = gnomonShadowLight;
    uint layer = dot(r.fromLight, gnomonShadows[light].parts[8].xyz) >= 0.0 ? 0u : 1u;
    Paraboloid part;
    part.rightWs = gnomonShadows[light].parts[4u * layer];
    part.downWs = gnomonShadows[light].parts[4u * layer + 1u];
    part.axisWs = gnomonShadows[light].parts[4u * layer + 2u];
    part.poleWs = gnomonShadows[light].parts[4u * layer + 3u];
    DiscTap at = discTap(look, part, r, float(layer));
    return look.filterSide > 1.0 ? boxVisibility(at, at.at, look.filterSide) : nearestVisibility(at, at.at);
}

// Visibility in [0, 1]: 1 also where the light does not reach, or has no map; 0 also where the normal faces away.
//   light     index into the view's pLights
//   position  metres, in the coordinates that pOrigin of gnGetSampledShadows() is the zero of
//   normal    unit, geometric; turn it to the light where both sides are lit. (0, 0, 0): of no surface, as of smoke
float gn_sampleShadow(uint light, vec3 position, vec3 normal)
{
    PlaneReceiver r = gnomonShadowReceiver(light, position, normal);
    if (r.decided) return r.visibility;
    MapLookup look = gnomonShadows[gnomonShadowLight].map;
    if (gnomonShadows[gnomonShadowLight].kind == SAMPLE_DISCS) return gnomonShadowDisc(look, r);
    vec4 clip;
    CascadeTaps taps = gnomonShadowTaps(look, r, clip);
    if (look.filterSide <= 1.0) return nearestVisibility(taps.fine, taps.fine.at);
    float fine = kernelVisibility(taps.fine, taps.fine.at, look.filterSide, look.kernel);
    if (taps.coarseShare <= 0.0) return fine;
    float coarse = kernelVisibility(taps.coarse, taps.coarse.at, look.filterSide, look.kernel);
    return fine + taps.coarseShare * (coarse - fine);
}

#ifdef GNOMON_SHADOW_REVECTORIZED
#include "../revectorized/revectorize.h"

// The same with the stairs of texels made lines, unfiltered: what `rbsm` shows with `longest` 16. Paraboloids are asked
// as by gn_sampleShadow().
float gn_sampleShadowRevectorized(uint light, vec3 position, vec3 normal)
{
    PlaneReceiver r = gnomonShadowReceiver(light, position, normal);
    if (r.decided) return r.visibility;
    MapLookup look = gnomonShadows[gnomonShadowLight].map;
    if (gnomonShadows[gnomonShadowLight].kind == SAMPLE_DISCS) return gnomonShadowDisc(look, r);
    vec4 clip;
    CascadeTaps taps = gnomonShadowTaps(look, r, clip);
    return revectorizedVisibility(taps.fine, taps.fine.at, uint(GNOMON_SHADOW_REVECTORIZED), 16u);
}
#endif

#ifdef GNOMON_SHADOW_SOFT
#include "../shared/blocker_search.h"
#ifdef GNOMON_HLSL
static DiscCone disc; // of gnomonShadowLight
#else
DiscCone disc; // of gnomonShadowLight
#endif
#include "../shared/light_cone.glsl"
#include "../shared/disc_visibility.glsl"

// Half width, in texels, of what may hide the disc. `pcss` has a pyramid of depths to find the nearest one with. Here
// taps that lie the denser the nearer to the receiver's own place look for it.
float gnomonShadowSpread(LightCone cone, float side, vec2 direction)
{
    float widest = min(spreadAt(cone, 0.0), side), nearest = cone.own;
    for (int i = 0; i < SEARCH_TAPS; ++i) {
        float part = (float(i) + 0.5) / float(SEARCH_TAPS);
        float fromMiddle = widest * part * part * part;
        vec2 texel = floor(placeOf(cone, direction, fromMiddle)) + 0.5;
        float depth = mapTexel(cone.tap, texel);
        bool blocks = min(tapDepth(cone.tap, texel), 1.0) > depth && fromMiddle <= spreadAt(cone, depth) + 1.0;
        nearest = blocks ? min(nearest, depth) : nearest;
        direction = nextDirection(direction);
    }
    // Where none has found a blocker, one of them may have missed it narrowly.
    return min(nearest < cone.own ? max(spreadAt(cone, nearest), 1.5) : side / 32.0, widest);
}

// The same with the penumbra of the light's radius, as `pcss` estimates it (Fernando 2005). A light without a radius,
// cascades and paraboloids are asked as by gn_sampleShadow().
float gn_sampleShadowSoft(uint light, vec3 position, vec3 normal)
{
    PlaneReceiver r = gnomonShadowReceiver(light, position, normal);
    if (r.decided) return r.visibility;
    MapLookup look = gnomonShadows[gnomonShadowLight].map;
    uint kind = gnomonShadows[gnomonShadowLight].kind;
    disc.radius = gnomonShadows[gnomonShadowLight].eye.w;
    if (disc.radius <= 0.0 || kind == SAMPLE_DISCS || kind == SAMPLE_PARTS)
        return gn_sampleShadow(light, position, normal);
    vec4 clip;
    Tap tap = gnomonShadowTaps(look, r, clip).fine;
    bool sun = look.positional == 0.0;
    disc.texelWs = kind == SAMPLE_CUBE ? 2.0 * look.slope / look.side : length(look.texelDx.xyz);
    disc.tangentPerTexel = sun ? 0.0 : disc.texelWs;
    disc.reach = disc.radius * (sun ? length(look.axisWs.xyz) : 1.0 / abs(look.depthScale)) / disc.texelWs;
#ifdef GNOMON_SHADOW_PIXEL
    vec2 direction = firstDirection(GNOMON_SHADOW_PIXEL);
#else
    vec2 direction = firstDirection(floor(8.0 * tap.at));
#endif
    LightCone cone = lightCone(look, tap, mapDepth(look, clip));
    Blockers found = blockersIn(cone, gnomonShadowSpread(cone, look.side, direction), direction);
    if (found.count <= 0.0) return shareAbove(look, r, disc.radius);
    float spread = max(spreadAt(cone, found.mean), 0.5); // the edge of a map is not sharper than half a texel
    return discVisibility(cone, spread, direction, uint(GNOMON_SHADOW_SOFT)) * shareAbove(look, r, disc.radius);
}
#endif

#ifdef GNOMON_SHADOW_MOMENTS
#ifndef GNOMON_SHADOW_MOMENTS_FILTER
#define GNOMON_SHADOW_MOMENTS_FILTER 5
#endif
#ifndef GNOMON_SHADOW_MOMENTS_BLEEDING
#define GNOMON_SHADOW_MOMENTS_BLEEDING 0.1
#endif
#include "../filtered/moment_bounds.h"

MomentBounds gnomonShadowBounds()
{
    MomentBounds k;
    k.kind = uint(GNOMON_SHADOW_MOMENTS);
    k.exponent = 40.0;
    k.deviation = MOMENT_DEVIATION;
    k.momentBias = MOMENT_BIAS;
    return k;
}

vec4 gnomonShadowMomentsOf(LinearDepth ends, float depth)
{
    MomentBounds k = gnomonShadowBounds();
    return momentsOf(k.kind, k.exponent, linearZ(ends, depth));
}

// `moments` averages whole maps beforehand; here the box around the receiver is averaged when it is asked.
vec4 gnomonShadowMean(LinearDepth ends, Tap tap, float side)
{
    vec2 low = tap.at - 0.5 * side;
    vec2 base = floor(low);
    vec2 part = low - base;
    vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
    for (float y = 0.0; y < side; y += 2.0) { // bound: MAX_KERNEL_SIDE
        vec2 wy = vec2(y == 0.0 ? 1.0 - part.y : 1.0, y + 1.0 == side ? part.y : 1.0);
        for (float x = 0.0; x < side; x += 2.0) { // bound: MAX_KERNEL_SIDE
            vec2 wx = vec2(x == 0.0 ? 1.0 - part.x : 1.0, x + 1.0 == side ? part.x : 1.0);
            vec4 depths = mapGather(tap, base + vec2(x, y) + 1.0);
            sum += wx.x * wy.y * gnomonShadowMomentsOf(ends, depths.x);
            sum += wx.y * wy.y * gnomonShadowMomentsOf(ends, depths.y);
            sum += wx.y * wy.x * gnomonShadowMomentsOf(ends, depths.z);
            sum += wx.x * wy.x * gnomonShadowMomentsOf(ends, depths.w);
        }
    }
    return sum / (side * side);
}

float gnomonShadowBound(MapLookup look, Tap tap)
{
    if (look.positional == 0.0 && !texelExists(tap, tap.at)) return 1.0; // beside a sun's map there is no caster
    LinearDepth ends;
    ends.perspective = look.positional;
    ends.scale = look.positional != 0.0 ? -look.depthScale / max(look.farWs, 1e-6) : 1.0;
    ends.offset = ends.padding = 0.0;
    float side = clamp(float(GNOMON_SHADOW_MOMENTS_FILTER), 1.0, float(MAX_KERNEL_SIDE));
    float deviation = side * 0.28867513; // of places in the box along an axis: sqrt(1 / 12)
    float nearer = linearZ(ends, tap.depth - deviation * length(tap.depthPerTexel));
    float lit = momentsLit(gnomonShadowBounds(), gnomonShadowMean(ends, tap, side), linearZ(ends, tap.depth), nearer);
    return withoutBleeding(lit, GNOMON_SHADOW_MOMENTS_BLEEDING);
}

// The same by statistics of the depths in a box, VSM to MSM, as `moments` has them with `bits` 32, `boxes` 1 and
// `exponent` 40. (filter + 1)^2 texels are read. Paraboloids are asked as by gn_sampleShadow().
float gn_sampleShadowMoments(uint light, vec3 position, vec3 normal)
{
    PlaneReceiver r = gnomonShadowReceiver(light, position, normal);
    if (r.decided) return r.visibility;
    MapLookup look = gnomonShadows[gnomonShadowLight].map;
    if (gnomonShadows[gnomonShadowLight].kind == SAMPLE_DISCS) return gnomonShadowDisc(look, r);
    vec4 clip;
    CascadeTaps taps = gnomonShadowTaps(look, r, clip);
    float fine = gnomonShadowBound(look, taps.fine);
    if (taps.coarseShare <= 0.0) return fine;
    return fine + taps.coarseShare * (gnomonShadowBound(look, taps.coarse) - fine);
}
#endif
#endif
