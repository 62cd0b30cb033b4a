// What all shaders read in a frame (std140; FrameData in renderer.hpp), and how a light falls on a surface.
const int LIGHT_COUNT = 3;

struct Light {
    vec4 positionAndRange; // world, metres; unlimited where range is 0
    vec4 direction;        // the way the light travels; w: cosine of the cone's half angle, -1 where there is none
    vec4 colour;           // w: 0 for the sun, whose light comes from afar, else 1
};

layout(set = 0, binding = 0, std140) uniform Frame {
    mat4 clipFromWorld;
    vec4 eye;       // world, metres; w: near plane, metres
    vec4 viewRight; // rows of viewFromWorld; w of the first two: clip per view at distance 1
    vec4 viewUp;
    vec4 viewBack;
    Light lights[LIGHT_COUNT];
} frame;

vec3 toLight(Light light, vec3 position)
{
    return light.colour.w == 0.0 ? -light.direction.xyz : light.positionAndRange.xyz - position;
}

// Unshadowed.
vec3 lightOn(Light light, vec3 position, vec3 normal)
{
    const vec3 there = toLight(light, position);
    const float away = length(there), range = light.positionAndRange.w;
    const bool outside = dot(light.direction.xyz, -there) < light.direction.w * away || (range > 0.0 && away > range);
    const float fade = range > 0.0 ? 1.0 - min(away / range, 1.0) : 1.0;
    return outside ? vec3(0.0) : light.colour.rgb * max(dot(normal, there) / away, 0.0) * fade * fade;
}
