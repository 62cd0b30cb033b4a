#version 460
// Visibility from the filtered moments of a light's depths. With MAP_LAYERS they are those of the six faces around a
// point light.
#extension GL_GOOGLE_include_directive : require
#include "moments.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    LinearDepth linear;
    uint kind;
    uint bits;
    float exponent;
    float bleeding;
    float deviation;
    float momentBias;
    float levels;
    float planeTexels;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#ifdef MAP_LAYERS
layout(set = 0, binding = 4) uniform sampler2DArray map;
#else
layout(set = 0, binding = 4) uniform sampler2D map;
#endif
layout(set = 0, binding = 5) uniform usampler2DArray moments;
layout(set = 0, binding = 6) uniform usampler2DArray smaller;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;
// 0: a kind with two moments, or twice two. 1: MSM.
layout(constant_id = 1) const bool FOUR = false;

#include "../shared/agreement.glsl"
#include "moment_words.glsl"

vec4 unpacked(uvec4 words)
{
    uint channels = momentChannels(kind);
    bool halves = bits == 16u ? channels == 4u : channels == 2u;
    if (halves) words = wordsOf(words);
    return unpackedMoments(FOUR ? MOMENTS_MSM : kind, bits, words);
}

// Filtered moments between texels: each is a linear function of what was filtered, so that they may be mixed. level 0: of
// the map, others of the smaller ones.
vec4 mixedMoments(uint level, vec2 at, float layer)
{
    uint mapSide = uint(constants.map.side), side = mapSide >> level;
    ivec2 corner = level == 0u ? ivec2(0) : ivec2(momentLevelCorner(mapSide, level));
    vec2 place = clamp(at * exp2(-float(level)) - 0.5, vec2(0.0), vec2(float(side) - 1.0));
    ivec2 base = min(ivec2(place), ivec2(max(int(side) - 2, 0)));
    vec2 part = place - vec2(base);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) { // one body, not four: drivers take a time to compile it
        ivec2 aside = ivec2(i & 1, i >> 1);
        ivec3 texel = ivec3(corner + min(base + aside, ivec2(int(side) - 1)), layer);
        uvec4 words = level == 0u ? texelFetch(moments, texel, 0) : texelFetch(smaller, texel, 0);
        vec2 share = mix(1.0 - part, part, vec2(aside));
        sum += share.x * share.y * unpacked(words);
    }
    return sum;
}

// How far the middles of neighbouring pixels are apart on the map, texels, where both see the receiver's plane.
vec2 onMap(PlaneReceiver r, vec4 clip, float layer, vec3 rayStep)
{
    vec3 looking = lookingWs(constants.view, r.ray);
    vec3 stepWs = rayStep - looking * (dot(r.normalWs, rayStep) / dot(r.normalWs, looking));
#ifdef MAP_LAYERS
    vec4 change = cubeClip(constants.map, r.w * stepWs, uint(layer));
#else
    vec4 change = constants.map.clipFromRay * vec4(r.w * stepWs, 0.0);
#endif
    return (change.xy - clip.xy * (change.w / clip.w)) / clip.w;
}

// The level whose texels, filtered and mixed, have the variance of a pixel's places on the map; 0 where the filter alone
// has it. Twelve times the variances along an axis: of the filter 12 planeTexels^2, of 2^n texels in a row 4^n - 1, of
// mixing two 2 * 4^n; of a square its side squared. A pixel's place there is long where the view is flat: its area, not
// its length, or what is across would be lost.
float levelOf(PlaneReceiver r, vec4 clip, float layer)
{
    vec2 x = onMap(r, clip, layer, constants.view.rayDxWs.xyz), y = onMap(r, clip, layer, constants.view.rayDyWs.xyz);
    float area = abs(x.x * y.y - x.y * y.x);
    float wanted = (area - 12.0 * planeTexels * planeTexels + 1.0) / 3.0;
    // Compared so that what is no number is level 0.
    return wanted > 1.0 ? min(0.5 * log2(wanted), levels) : 0.0;
}

vec4 levelledMoments(float level, vec2 at, float layer)
{
    uint lower = uint(level);
    float part = level - float(lower);
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < 2u; ++i) {
        float share = i == 0u ? 1.0 - part : part;
        if (share > 0.0) sum += share * mixedMoments(lower + i, at, layer);
    }
    return sum;
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    float level = levels > 0.0 && !r.decided ? levelOf(r, clip, layer) : 0.0;
    float spread = planeTexels;
    if (level > 0.0) spread = sqrt(spread * spread + 0.25 * (exp2(2.0 * level) - 1.0));
    float nearer = linearZ(linear, tap.depth - spread * length(tap.depthPerTexel));

    MomentBounds k;
    k.kind = FOUR ? MOMENTS_MSM : min(kind, MOMENTS_EVSM4);
    k.exponent = exponent;
    k.deviation = deviation;
    k.momentBias = momentBias;
    float lit = withoutBleeding(momentsLit(k, levelledMoments(level, tap.at, layer), linearZ(linear, tap.depth), nearer), bleeding);
    // Beside a directional light's map there is no caster.
    bool beside = constants.map.positional == 0.0 && !texelExists(tap, tap.at);
    visibility = r.decided ? r.visibility : beside ? 1.0 : lit;
}
