#version 450
// Four stages, one each time that this file is compiled: with its name in capitals, such as GLASS_FRAG, defined.
#extension GL_GOOGLE_include_directive : require
const int LIGHT_COUNT = 3;

struct Light {
    vec4 position;  // world, metres; w: 1, or 0 of the sun, to which xyz points
    vec4 direction; // the way the light travels; w: cosine of the cone's half angle, -1 where there is none
    vec4 colour;    // w: range, metres; 0: unlimited
};
layout(binding = 3) uniform sampler2D surfaces[3]; // the G-buffer: albedo, normal, depth
layout(binding = 5, std140) uniform Frame {        // FrameData in renderer.hpp
    mat4 worldFromClip;
    Light lights[LIGHT_COUNT];
} frame;
layout(push_constant) uniform Object { // ObjectData there
    mat4 clipFromWorld;
    vec4 colour;
} object;

vec3 toLight(Light light, vec3 position) { return light.position.xyz - light.position.w * position; }

vec3 unshadowed(Light light, vec3 position, vec3 normal)
{
    const vec3 there = toLight(light, position);
    const float away = length(there), range = light.colour.w;
    const bool outside = dot(light.direction.xyz, -there) < light.direction.w * away || (range > 0.0 && away > range);
    const float fade = range > 0.0 ? 1.0 - min(away / range, 1.0) : 1.0;
    return outside ? vec3(0.0) : light.colour.rgb * max(dot(normal, there) / away, 0.0) * fade * fade;
}

#if defined(CORNER_VERT)
layout(location = 0) in vec3 position;
layout(location = 0) out vec3 positionWs;

void main()
{
    positionWs = position;
    gl_Position = object.clipFromWorld * vec4(position, 1.0);
}

#elif defined(SURFACE_FRAG) // G-buffer: albedo, and the geometric normal of the side that is seen
layout(location = 0) in vec3 positionWs;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normalWs;

void main()
{
    albedo = object.colour;
    normalWs = vec4(normalize(cross(dFdy(positionWs), dFdx(positionWs))), 0.0);
}

#elif defined(LIGHTING_FRAG) // deferred: adds up the lights at every pixel, each times its visibility
#define GNOMON_VISIBILITY_BINDING 4
#include "gnomon/visibility.glsl"
layout(location = 0) out vec4 colour;

void main()
{
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const vec3 albedo = texelFetch(surfaces[0], pixel, 0).rgb, normalWs = texelFetch(surfaces[1], pixel, 0).xyz;
    const float depth = texelFetch(surfaces[2], pixel, 0).x; // reversed, no far plane: 0 is the sky
    const vec2 clip = 2.0 * gl_FragCoord.xy / vec2(textureSize(surfaces[2], 0)) - 1.0;
    const vec4 position = frame.worldFromClip * vec4(clip, max(depth, 1e-6), 1.0);
    vec3 sum = vec3(0.08);
    for (int i = 0; i < LIGHT_COUNT; ++i)
        sum += unshadowed(frame.lights[i], position.xyz / position.w, normalWs) * gnomonVisibility(pixel, i);
    colour = vec4(depth == 0.0 ? vec3(0.1, 0.12, 0.16) : albedo * sum, 1.0);
}

#elif defined(GLASS_FRAG) // forward: it is in no depth image, so its shadows are looked up here
#define GNOMON_SHADOW_LIGHTS LIGHT_COUNT
#include "gnomon/sample_shadow.h" // its bindings are 0 to 2
layout(location = 0) in vec3 positionWs;
layout(location = 0) out vec4 colour;

void main()
{
    const vec3 normal = normalize(cross(dFdy(positionWs), dFdx(positionWs)));
    if (texelFetch(surfaces[2], ivec2(gl_FragCoord.xy), 0).x > gl_FragCoord.z) discard; // it is behind
    vec3 sum = vec3(0.08);
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        const Light light = frame.lights[i];
        const vec3 lit = dot(normal, toLight(light, positionWs)) < 0.0 ? -normal : normal; // frosted: from either side
        sum += unshadowed(light, positionWs, lit) * gn_sampleShadow(i, positionWs, lit);
    }
    colour = vec4(object.colour.rgb * sum, object.colour.a);
}
#endif
