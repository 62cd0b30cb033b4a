#version 460
// Four lights a texel, of a view whose visibility is packed. Lights that there are not are lit.
layout(set = 0, binding = 0) uniform sampler2DArray visibilityImage; // a layer a light
layout(push_constant) uniform Push
{
    int first; // light in x
    int count; // of lights
};

layout(location = 0) out vec4 packedVisibility;

float ofLight(int light)
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    return light < count ? texelFetch(visibilityImage, ivec3(pixel, min(light, count - 1)), 0).x : 1.0;
}

void main()
{
    packedVisibility = vec4(ofLight(first), ofLight(first + 1), ofLight(first + 2), ofLight(first + 3));
}
