#version 450
// Forward: frosted glass over what is lit already. It is in no depth image: its shadows are looked up here.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#define GNOMON_SHADOW_SET 0
#define GNOMON_SHADOW_BINDING 5
#define GNOMON_SHADOW_MAPS_BINDING 6
#define GNOMON_SHADOW_SAMPLER_BINDING 7
#define GNOMON_SHADOW_LIGHTS LIGHT_COUNT
#include "gnomon/sample_shadow.h"
layout(set = 0, binding = 3) uniform sampler2D depthImage; // without the glass
layout(location = 0) in vec3 positionWs;
layout(location = 0) out vec4 colour;
layout(push_constant) uniform Object { vec4 colour; } object;

void main()
{
    const vec3 normal = normalize(cross(dFdx(positionWs), dFdy(positionWs)));
    if (texelFetch(depthImage, ivec2(gl_FragCoord.xy), 0).x > gl_FragCoord.z) discard; // reversed: it is behind
    vec3 sum = vec3(0.08);
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        const Light light = frame.lights[i];
        const vec3 lit = dot(normal, toLight(light, positionWs)) < 0.0 ? -normal : normal; // frosted: from either side
        sum += lightOn(light, positionWs, lit) * gn_sampleShadow(i, positionWs, lit);
    }
    colour = vec4(object.colour.rgb * sum, object.colour.a);
}
