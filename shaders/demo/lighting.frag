#version 460
// Lambert under every light, times what gnomon says. Plain on purpose: the shadows are the subject.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#define GNOMON_VISIBILITY_SET 1
#define GNOMON_VISIBILITY_BINDING 2
#include "gnomon/visibility.glsl"

layout(set = 1, binding = 0) uniform sampler2D depthImage;
layout(set = 1, binding = 1) uniform sampler2D normalImage;

layout(location = 0) in vec3 ray;
layout(location = 0) out vec4 colour; // sRGB-encoded by hand: the picture files and the swapchain take it as it is

const vec3 kAmbientUp = vec3(0.16, 0.18, 0.22);
const vec3 kAmbientDown = vec3(0.07, 0.06, 0.06);

// Falls smoothly to zero at the range; inside, no inverse square, so that intensity means what it says in scene files.
float attenuation(DemoLight light, vec3 fromLight, vec3 towardsLight)
{
    if (light.type == LIGHT_DIRECTIONAL) return 1.0;
    float reach = light.colour.w > 0.0 ? min(length(fromLight) / light.colour.w, 1.0) : 0.0;
    float window = 1.0 - reach * reach;
    float cone = light.type == LIGHT_SPOT
                     ? smoothstep(light.direction.w, light.cosInner, -dot(towardsLight, light.direction.xyz))
                     : 1.0;
    return window * window * cone;
}

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

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    if (depth == view.skyDepth) {
        colour = vec4(encodeSrgb(view.sky.rgb), 1.0);
        return;
    }
    vec4 normalAndInstance = texelFetch(normalImage, pixel, 0);
    vec3 n = normalAndInstance.xyz;
    vec3 position = ray * (view.depthScale / (depth + view.depthAdd));
    vec3 light = view.ambient * mix(kAmbientDown, kAmbientUp, 0.5 + 0.5 * n.y);
    uvec2 tile = min(uvec2(gl_FragCoord.xy / view.extent.zw), uvec2(LIGHT_TILES - 1u));
    uint firstWord = (tile.y * LIGHT_TILES + tile.x) * LIGHT_TILE_WORDS;
    for (uint word = 0u; word < LIGHT_TILE_WORDS; ++word) {
        uint bits = view.tileLights[firstWord + word];
        for (uint bit = 0u; bit < 32u && bits != 0u; ++bit) {
            uint i = word * 32u + uint(findLSB(bits));
            bits &= bits - 1u;
            vec3 fromLight = position - view.lights[i].positionEye.xyz;
            bool directional = view.lights[i].type == LIGHT_DIRECTIONAL;
            vec3 towards = directional ? -view.lights[i].direction.xyz : -normalize(fromLight);
            float lambert = max(dot(n, towards), 0.0) * attenuation(view.lights[i], fromLight, towards);
            light += view.lights[i].colour.rgb * (lambert * gnomonVisibility(pixel, int(i)));
        }
    }
    vec3 albedo = instances[uint(normalAndInstance.w + 0.5)].albedo.rgb;
    colour = vec4(encodeSrgb(film(albedo * light)), 1.0);
}
