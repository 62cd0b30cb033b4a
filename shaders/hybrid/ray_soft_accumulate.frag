#version 460
// What a pixel's rays have found, of this frame and of those before that looked at the same place.
#extension GL_GOOGLE_include_directive : require
#include "ray_soft.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RaySoftConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2D seenImage;
layout(set = 0, binding = 5) uniform sampler2D pastImage;
layout(set = 0, binding = 7) uniform sampler2D nowImage; // of this frame alone, blurred; where hold() asks
layout(set = 0, binding = 8) uniform sampler2D motionImage;
layout(set = 0, binding = 6, std430) readonly buffer SoftCameras {
    ViewConstants views[2];
};
// x: visibility; y: half the penumbra's width, metres, 0 not known, below it not asked; z: frames, by the weights of their
// rays; w: the depth value
layout(location = 0) out vec4 history;
layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "../shared/soft_surface.glsl"

// Frames that count where the light or a caster moves: shadows lag by about half of them, in penumbrae alone (hold()).
const float MOVED_FRAMES = 6.0;
// Share of a pixel within which a place counts as drawn at the pixel's centre: a camera that stands still resamples nothing.
const float SAME_PIXEL = 0.02;

// Pixels from where a surface at rest was drawn, above which a motion vector says that it moves. Vectors of 16-bit
// floats are off by less up to a thousand pixels.
const float MOVES = 0.5;

// Where the surface was, in the history's view.
struct Before {
    vec2 drawn;    // pixels
    vec3 atWs;
    float slackWs; // how far from its plane the history may lie, metres
};

// Of a surface at rest.
Before atRest(ViewConstants view, Surface surface)
{
    return Before(drawnAt(view, constants.base.area, surface.atWs), surface.atWs, 2.0 * surface.pixelWs);
}

// As its motion vector says. @return false where it says nothing, or that it rests
bool hasMoved(ViewConstants view, Surface surface, ivec2 pixel, inout Before before)
{
    if ((constants.state.x & SOFT_MOTION) == 0u) return false;
    vec3 motion = texelFetch(motionImage, pixel, 0).xyz * constants.motion.xyz;
    vec2 drawn = vec2(pixel) + 0.5 + motion.xy;
    float pixels = length(drawn - before.drawn);
    if (!(pixels > MOVES)) return false;
    vec4 clip = view.clipFromWorld * vec4(surface.atWs, 1.0);
    float away = viewDistance(view, clip.z / clip.w);
    if (constants.motion.z != 0.0)
        away = viewDistance(constants.base.view, surface.depth) + motion.z;
    else
        before.slackWs += pixels * surface.pixelWs; // it may have moved as far off its plane as across the view
    before.drawn = drawn;
    before.atWs = view.eyeWs.xyz + atDistanceWs(view, viewRayWs(view, drawn), away);
    return true;
}

// The history of what is seen at the pixel, bilinear over those of four that lay on the same plane. z = 0: there is none.
vec4 pastOf(ViewConstants view, Surface surface, Before before)
{
    vec4 area = constants.base.area;
    if (!isInside(area, before.drawn)) return vec4(0.0);
    surface.atWs = before.atWs;
    vec2 at = before.drawn - 0.5;
    if (all(lessThan(abs(at - round(at)), vec2(SAME_PIXEL)))) at = round(at);
    ivec2 first = ivec2(floor(at));
    vec2 part = at - floor(at);
    vec4 sum = vec4(0.0);
    float weights = 0.0, known = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i & 1, i >> 1), pixel = first + step;
        vec2 share = mix(1.0 - part, part, vec2(step));
        if (share.x * share.y == 0.0 || !isInside(area, vec2(pixel))) continue;
        vec4 past = texelFetch(pastImage, pixel, 0);
        if (!(past.z > 0.0)) continue;
        if (!(offPlane(surface, placeWs(view, pixel, past.w)) <= before.slackWs)) continue;
        sum += share.x * share.y * past;
        weights += share.x * share.y;
        known += past.y > 0.0 ? share.x * share.y : 0.0;
    }
    if (!(weights > 0.05)) return vec4(0.0);
    float width = known > 0.0 ? sum.y / known : 0.0; // of those that know it: others would make it narrower
    return vec4(sum.x / weights, width, sum.zw / weights);
}

// The past may be of a shadow that has moved on. It is held within what rays around the pixel say now, and how surely: mean and
// standard error, as M. Salvi, "An excursion in temporal supersampling" (GDC 2016), holds colours. Where all of them agree,
// which is umbra or light, nothing of it stays. What was held back counts as so many frames less.
vec4 hold(vec4 past, ivec2 pixel)
{
    vec4 now = texelFetch(nowImage, pixel, 0);
    float rays = max(now.w, 1.0) * float(clamp(constants.state.y, 1u, SOFT_RAYS));
    float off = sqrt(max(now.x * (1.0 - now.x), 0.0) / rays);
    float held = clamp(past.x, now.x - off, now.x + off);
    past.z = min(past.z, MOVED_FRAMES) * (1.0 - min(abs(held - past.x), 1.0));
    past.x = held;
    return past;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 now = texelFetch(seenImage, pixel, 0).xyz;
    history = vec4(now.xy, 0.0, 0.0);
    if (!(now.y >= 0.0)) return;
    Surface surface = surfaceAt(constants.base.view, constants.base.area, pixel);
    vec4 past = vec4(0.0);
    if ((constants.state.x & SOFT_HAS_PAST) != 0u) {
        ViewConstants view = views[min(constants.state.w, 1u)];
        Before before = atRest(view, surface);
        past = pastOf(view, surface, before);
        bool moves = hasMoved(view, surface, pixel, before);
        if (moves) { // its shadow may have come along, or stayed: this frame's rays say which
            vec4 along = pastOf(view, surface, before);
            float seen = texelFetch(nowImage, pixel, 0).x;
            if (along.z > 0.0 && (!(past.z > 0.0) || abs(along.x - seen) < abs(past.x - seen))) past = along;
        }
        if (past.z > 0.0 && (moves || (constants.state.x & SOFT_MOVED) != 0u)) past = hold(past, pixel);
    }
    float frames = min(past.z, max(constants.disc.y - 1.0, 0.0)) + now.z;
    float share = frames > 0.0 ? now.z / frames : 1.0;
    float width = now.y == 0.0 ? past.y : past.y > 0.0 ? mix(past.y, now.y, max(share, 0.1)) : now.y;
    history = vec4(mix(past.x, now.x, share), width, frames, surface.depth);
}
