// Where a view's pixels are in the host's images. GN_SOURCE 1: of arrays; 2: several samples a pixel; 3: both.
#ifndef GNOMON_RUNTIME_HOST_IMAGE_GLSL
#define GNOMON_RUNTIME_HOST_IMAGE_GLSL
#ifndef GN_SOURCE
#define GN_SOURCE 0
#endif
#if GN_SOURCE == 3
layout(set = 0, binding = 0) uniform sampler2DMSArray hostImage;
#elif GN_SOURCE == 1
layout(set = 0, binding = 0) uniform sampler2DArray hostImage;
#elif GN_SOURCE == 2
layout(set = 0, binding = 0) uniform sampler2DMS hostImage;
#else
layout(set = 0, binding = 0) uniform sampler2D hostImage;
#endif

layout(push_constant) uniform Push
{
    vec4 straight; // of an oblique near plane, runtime/scene/scene_view.hpp
    float skyDepth;
    int layer;
    int judgedSample;
    uint way; // depth: 1 with an oblique near plane; normals: GnNormalEncoding
};

vec4 hostTexel()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
#if GN_SOURCE == 3
    return texelFetch(hostImage, ivec3(pixel, layer), judgedSample);
#elif GN_SOURCE == 1
    return texelFetch(hostImage, ivec3(pixel, layer), 0);
#elif GN_SOURCE == 2
    return texelFetch(hostImage, pixel, judgedSample);
#else
    return texelFetch(hostImage, pixel, 0);
#endif
}
#endif
