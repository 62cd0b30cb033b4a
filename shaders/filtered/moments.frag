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
    float padding0;
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
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;
// 0: a kind with two moments, or twice two. 1: MSM.
layout(constant_id = 1) const bool FOUR = false;

#include "../shared/agreement.glsl"
#include "moment_words.glsl"

vec4 momentsAt(ivec3 texel)
{
    uvec4 words = texelFetch(moments, texel, 0);
    uint channels = momentChannels(kind);
    bool halves = bits == 16u ? channels == 4u : channels == 2u;
    if (halves) words = wordsOf(words);
    return unpackedMoments(FOUR ? MOMENTS_MSM : kind, bits, words);
}

// Filtered moments between texels: each is a linear function of what was filtered, so that they may be mixed.
vec4 mixedMoments(vec2 at, float layer)
{
    float last = constants.map.side - 1.0;
    vec2 place = clamp(at - 0.5, vec2(0.0), vec2(last));
    vec2 base = min(floor(place), vec2(max(last - 1.0, 0.0)));
    vec2 part = place - base;
    ivec3 texel = ivec3(base, layer);
    ivec2 next = ivec2(min(base + 1.0, vec2(last))) - texel.xy;
    vec4 above = mix(momentsAt(texel), momentsAt(texel + ivec3(next.x, 0, 0)), part.x);
    vec4 below = mix(momentsAt(texel + ivec3(0, next.y, 0)), momentsAt(texel + ivec3(next, 0)), part.x);
    return mix(above, below, part.y);
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    float nearer = linearZ(linear, tap.depth - planeTexels * length(tap.depthPerTexel));

    MomentBounds k;
    k.kind = FOUR ? MOMENTS_MSM : min(kind, MOMENTS_EVSM4);
    k.exponent = exponent;
    k.deviation = deviation;
    k.momentBias = momentBias;
    float lit = withoutBleeding(momentsLit(k, mixedMoments(tap.at, layer), linearZ(linear, tap.depth), nearer), bleeding);
    // Beside a directional light's map there is no caster.
    bool beside = constants.map.positional == 0.0 && !texelExists(tap, tap.at);
    visibility = r.decided ? r.visibility : beside ? 1.0 : lit;
}
