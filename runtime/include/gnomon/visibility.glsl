// How a host's shader reads gnomon's visibility. Bind GnVisibility::imageView (any sampler) to one combined image
// sampler and include this file after saying where it is:
//
//     #define GNOMON_VISIBILITY_SET 1
//     #define GNOMON_VISIBILITY_BINDING 2
//     #include "gnomon/visibility.glsl"
//     ...
//     float lit = gnomonVisibility(ivec2(gl_FragCoord.xy), i); // 1 lit, 0 umbra, for GnViewFrame::pLights[i]
//
// How the answers are packed is gnomon's business and may change; this function follows.
#ifndef GNOMON_VISIBILITY_GLSL
#define GNOMON_VISIBILITY_GLSL

#ifndef GNOMON_VISIBILITY_SET
#define GNOMON_VISIBILITY_SET 0
#endif
#ifndef GNOMON_VISIBILITY_BINDING
#define GNOMON_VISIBILITY_BINDING 0
#endif

layout(set = GNOMON_VISIBILITY_SET, binding = GNOMON_VISIBILITY_BINDING) uniform sampler2DArray gnomonVisibilityImage;

// `pixel`: of the view's depth image, inside the render area. `light`: index into the view's pLights of this frame.
float gnomonVisibility(ivec2 pixel, int light)
{
    return texelFetch(gnomonVisibilityImage, ivec3(pixel, light), 0).x;
}
#endif
