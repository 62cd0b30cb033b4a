#version 460
// How many pixels wide the texels of a light's map are where they are looked up: demo/program/aliasing.hpp has the
// measure, and the colours.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "attenuation.glsl"

layout(set = 1, binding = 0) uniform sampler2D depthImage;
layout(set = 1, binding = 1) uniform sampler2D normalImage;
layout(std430, set = 2, binding = 0) readonly buffer Map { DemoMap map; };

layout(location = 0) in vec3 ray;
layout(location = 0) out vec4 colour; // sRGB

const float kFullAt = 3.0; // log2 of the factor

// The gradients of both sample coordinates, of which neither changes along the beam: their cross product is along it,
// as long as there are samples in a square metre across it.
vec3 beam(mat4 clipFromEye, vec2 extent, vec3 at)
{
    mat4 rows = transpose(clipFromEye);
    vec4 clip = clipFromEye * vec4(at, 1.0);
    vec3 x = (rows[0].xyz - clip.x / clip.w * rows[3].xyz) * (0.5 * extent.x / clip.w);
    vec3 y = (rows[1].xyz - clip.y / clip.w * rows[3].xyz) * (0.5 * extent.y / clip.w);
    return cross(x, y);
}

// The layer that is looked up: of a cube's faces the one that the receiver lies deepest in, else the first that holds
// it; -1: none does.
int layerAt(vec3 at, bool cube)
{
    int best = -1;
    float deepest = 0.0;
    for (uint i = 0u; i < MAX_MAP_LAYERS && i < map.layers; ++i) {
        vec4 clip = map.clipFromEye[i] * vec4(at, 1.0);
        if (clip.w <= deepest || abs(clip.x) > clip.w || abs(clip.y) > clip.w || (best >= 0 && !cube)) continue;
        best = int(i);
        deepest = clip.w;
    }
    return best;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    colour = vec4(0.0, 0.0, 0.0, 1.0);
    if (depth == view.skyDepth) return;
    vec3 n = texelFetch(normalImage, pixel, 0).xyz;
    vec3 at = ray * (view.depthScale / (depth + view.depthAdd));
    DemoLight light = view.lights[map.light];
    vec3 fromLight = at - light.positionEye.xyz;
    vec3 towards = light.type == LIGHT_DIRECTIONAL ? -light.direction.xyz : -normalize(fromLight);
    // Shades of grey keep the shapes where no map is looked up.
    colour.rgb = vec3(0.05 + 0.15 * abs(dot(n, normalize(ray))));
    if (dot(n, towards) < GRAZING || attenuation(light, fromLight, towards) <= 0.0) return;
    int layer = layerAt(at, light.type == LIGHT_POINT);
    if (layer < 0) return;
    // Widths and cosines of aliasingOf(), in one root.
    float texels = abs(dot(n, beam(map.clipFromEye[layer], map.extent, at)));
    float pixels = abs(dot(n, beam(view.clipFromEye, view.extent.xy, at)));
    float factor = clamp(0.5 * log2(max(pixels, 1e-20) / max(texels, 1e-20)) / kFullAt, -1.0, 1.0);
    float other = 1.0 - abs(factor);
    colour.rgb = vec3(factor >= 0.0 ? 1.0 : other, other, factor <= 0.0 ? 1.0 : other);
}
