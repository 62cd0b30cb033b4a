#version 450
// Forward: frosted glass over what is lit already. Its shadows come from a view in whose depth the glass is.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#define GNOMON_VISIBILITY_SET 1
#define GNOMON_VISIBILITY_BINDING 4
#include "gnomon/visibility.glsl"
layout(set = 1, binding = 2) uniform sampler2D depthImage; // without the glass
layout(location = 0) in vec3 positionWs;
layout(location = 0) out vec4 colour;
layout(push_constant) uniform Object { vec4 colour; } object;

void main()
{
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (texelFetch(depthImage, pixel, 0).x > gl_FragCoord.z) discard; // reversed: something is before it
    vec3 sum = vec3(0.08);
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        const Light light = frame.lights[i]; // from either side: frosted
        const vec3 normal = normalize(cross(dFdx(positionWs), dFdy(positionWs)));
        sum += (lightOn(light, positionWs, normal) + lightOn(light, positionWs, -normal)) * gnomonVisibility(pixel, i);
    }
    colour = vec4(object.colour.rgb * sum, object.colour.a);
}
