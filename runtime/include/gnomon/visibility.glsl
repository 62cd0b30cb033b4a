// How a host's shader reads gnomon's visibility. Bind GnVisibility::imageView (any sampler) to one combined image
// sampler and include this file after saying where it is:
//
//     #define GNOMON_VISIBILITY_SET 1
//     #define GNOMON_VISIBILITY_BINDING 2
//     #include "gnomon/visibility.glsl"
//     ...
//     float lit = gnomonVisibility(ivec2(gl_FragCoord.xy), i); // 1 lit, 0 umbra, for GnViewFrame::pLights[i]
//
// Of a view with GN_VIEW_PACKED_BIT define GNOMON_VISIBILITY_PACKED as well; gnomonVisibility4() then has the answers of
// four lights at once.
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
#ifdef GNOMON_VISIBILITY_PACKED
    return texelFetch(gnomonVisibilityImage, ivec3(pixel, light / 4), 0)[light % 4];
#else
    return texelFetch(gnomonVisibilityImage, ivec3(pixel, light), 0).x;
#endif
}
#ifdef GNOMON_VISIBILITY_PACKED
// Of lights 4 * group to 4 * group + 3; 1 of those that there are not. `group`: below a quarter of the lights, rounded
// up.
vec4 gnomonVisibility4(ivec2 pixel, int group) { return texelFetch(gnomonVisibilityImage, ivec3(pixel, group), 0); }
#endif
#endif
