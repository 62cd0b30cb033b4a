#version 460
// Lambert under every light, times what gnomon says. Plain on purpose: the shadows are the subject.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "attenuation.glsl"
#define GNOMON_VISIBILITY_SET 1
#define GNOMON_VISIBILITY_BINDING 2
#include "gnomon/visibility.glsl"

layout(set = 1, binding = 0) uniform sampler2D depthImage;
layout(set = 1, binding = 1) uniform sampler2D normalImage;
#ifdef GNOMON_ERROR_VIEW
// Over the picture in grey: where another visibility, in the same layers, differs from the one that lights it.
layout(set = 2, binding = 2) uniform sampler2DArray judgedVisibility;
layout(std430, set = 3, binding = 0) buffer Counts { uvec2 counts[ERROR_COUNTS]; }; // of lights: x counted, y wrong
layout(push_constant) uniform Push {
    vec4 falseLit; // sRGB
    vec4 falseShadow;
};
#endif

layout(location = 0) in vec3 ray;
layout(location = 0) out vec4 colour; // sRGB-encoded by hand: the picture files and the swapchain take it as it is

const vec3 kAmbientUp = vec3(0.16, 0.18, 0.22);
const vec3 kAmbientDown = vec3(0.07, 0.06, 0.06);

vec3 encodeSrgb(vec3 linear)
{
    vec3 c = clamp(linear, 0.0, 1.0);
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, lessThanEqual(c, vec3(0.0031308)));
}

// A film's response with a toe and a shoulder: x^a / (b x^a + c). After T. Lottes, "Advanced Techniques and Optimization
// of HDR Color Pipelines", GDC 2016, with d = 1. b and c send 0.5 to 0.42 and 8 to 1.
vec3 film(vec3 linear)
{
    vec3 x = pow(max(linear, vec3(0.0)), vec3(1.3));
    return x / (0.961 * x + 0.577);
}

#ifdef GNOMON_ERROR_VIEW
vec4 marked(vec3 picture, float error)
{
    float grey = 0.15 + 0.6 * dot(picture, vec3(0.2126, 0.7152, 0.0722)); // neither end hides the colours
    return vec4(mix(vec3(grey), error > 0.0 ? falseLit.rgb : falseShadow.rgb, min(abs(error), 1.0)), 1.0);
}
#endif

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    if (depth == view.skyDepth) {
        colour = vec4(encodeSrgb(view.sky.rgb), 1.0);
#ifdef GNOMON_ERROR_VIEW
        colour = marked(colour.rgb, 0.0);
#endif
        return;
    }
    vec4 normalAndInstance = texelFetch(normalImage, pixel, 0);
    vec3 n = normalAndInstance.xyz;
    vec3 position = ray * (view.depthScale / (depth + view.depthAdd));
    vec3 light = view.ambient * mix(kAmbientDown, kAmbientUp, 0.5 + 0.5 * n.y);
    uvec2 tile = min(uvec2(gl_FragCoord.xy / view.extent.zw), uvec2(LIGHT_TILES - 1u));
#ifdef GNOMON_ERROR_VIEW
    float error = 0.0; // the largest of all lights
    uvec2 found = uvec2(0u);
#endif
    uint firstWord = (tile.y * LIGHT_TILES + tile.x) * LIGHT_TILE_WORDS;
    for (uint word = 0u; word < LIGHT_TILE_WORDS; ++word) {
        uint bits = view.tileLights[firstWord + word];
        for (uint bit = 0u; bit < 32u && bits != 0u; ++bit) {
            uint i = word * 32u + uint(findLSB(bits));
            bits &= bits - 1u;
            vec3 fromLight = position - view.lights[i].positionEye.xyz;
            bool directional = view.lights[i].type == LIGHT_DIRECTIONAL;
            vec3 towards = directional ? -view.lights[i].direction.xyz : -normalize(fromLight);
            float facing = max(dot(n, towards), 0.0);
            float lambert = facing * attenuation(view.lights[i], fromLight, towards);
            float visibility = gnomonVisibility(pixel, int(i));
            light += view.lights[i].colour.rgb * (lambert * visibility);
#ifdef GNOMON_ERROR_VIEW
            if (lambert > 0.0 && facing >= GRAZING) {
                float judged = texelFetch(judgedVisibility, ivec3(pixel, i), 0).x;
                if (abs(judged - visibility) > abs(error)) error = judged - visibility;
                found += uvec2(1u, (judged >= 0.5) != (visibility >= 0.5) ? 1u : 0u);
            }
#endif
        }
    }
    vec3 albedo = instances[instanceOfHalf(normalAndInstance.w)].albedo.rgb;
    colour = vec4(encodeSrgb(film(albedo * light)), 1.0);
#ifdef GNOMON_ERROR_VIEW
    colour = marked(colour.rgb, error);
    uint place = uint(pixel.x + pixel.y) % ERROR_COUNTS; // neighbours add to different ones
    if (found.x > 0u) atomicAdd(counts[place].x, found.x);
    if (found.y > 0u) atomicAdd(counts[place].y, found.y);
#endif
}
