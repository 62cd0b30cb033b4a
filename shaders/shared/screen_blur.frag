#version 460
// Filters a hard shadow along one axis of the ellipse that the penumbra is on the receiver's plane: first across the light's
// direction, then along it. Taps on other surfaces do not count.
#extension GL_GOOGLE_include_directive : require
#include "screen_penumbra.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uvec4 hard;
    DiscCone disc;
    LightConstants light;
    uint steps;
    float leastCosine;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2D seenImage; // of screen_penumbra.glsl
layout(set = 0, binding = 5) uniform sampler2D onceImage; // what the first pass made of x of it; that pass has seenImage here
layout(location = 0) out float filtered;
layout(constant_id = 0) const bool HAS_NORMALS = true;
layout(constant_id = 1) const bool IS_LAST = false;

#include "disc_points.glsl"
#include "soft_surface.glsl"

// Half of the ellipse's axis that this pass goes along, metres.
vec3 halfAxisWs(Surface surface, float halfWidth)
{
    vec3 n = surface.normalWs, toLight = towardsLightWs(light, surface.atWs);
    vec3 across = cross(n, toLight);
    float sine = length(across);
    if (!(sine > 1e-3)) { // a circle: any axis is one
        across = cross(n, abs(n.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
        sine = max(length(across), 1e-20);
    }
    across /= sine;
    return IS_LAST ? halfWidth / max(dot(n, toLight), leastCosine) * cross(n, across) : halfWidth * across;
}

vec2 pixelOf(vec4 clip)
{
    vec4 area = constants.map.area;
    return area.xy + (clip.xy / clip.w * 0.5 + 0.5) * area.zw;
}

// Weighted as a disc's chords are long: an edge along or across the axis gets the very ramp of a round light.
float blurred(ivec2 pixel, float halfWidth, float own)
{
    Surface surface = surfaceAt(constants.view, constants.map.area, pixel);
    vec3 axisWs = halfAxisWs(surface, halfWidth);
    vec4 middle = constants.view.clipFromWorld * vec4(surface.atWs, 1.0);
    vec4 axis = constants.view.clipFromWorld * vec4(axisWs, 0.0);
    axis *= min(1.0, 0.5 * middle.w / max(abs(axis.w), 1e-20)); // its ends are before the eye
    float pixels = 0.5 * length(pixelOf(middle + axis) - pixelOf(middle - axis));
    if (!(pixels > 0.5)) return own;
    float toEachSide = min(min(ceil(pixels), float(steps)), float(MAX_BLUR_STEPS));
    // Taps farther apart than pixels lie elsewhere in each pixel.
    float turn = toEachSide < pixels ? 0.5 * firstDirection(vec2(pixel)).x : 0.0;
    float sum = 0.0, weights = 0.0;
    for (float i = -toEachSide; i <= toEachSide; i += 1.0) { // bound: 2 MAX_BLUR_STEPS + 1
        float at = (i + turn) / (toEachSide + 0.5);
        vec2 drawn = pixelOf(middle + at * axis);
        if (!isInside(constants.map.area, drawn)) continue;
        ivec2 tap = ivec2(drawn);
        float visibility = texelFetch(onceImage, tap, 0).x;
        if (!(visibility >= 0.0)) continue; // not asked
        float weight = sqrt(max(1.0 - at * at, 0.0)) * nearness(constants.view, surface, tap, halfWidth);
        if (!(weight > 0.0)) continue; // nor is a number
        sum += weight * visibility;
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : own;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(seenImage, pixel, 0);
    filtered = IS_LAST ? texelFetch(onceImage, pixel, 0).x : seen.x;
    if (seen.y > 0.0) filtered = blurred(pixel, seen.y, filtered);
    if (IS_LAST) filtered = (filtered < 0.0 ? filtered + NOT_ASKED : filtered) * seen.z;
}
