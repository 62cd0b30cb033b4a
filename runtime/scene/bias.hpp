#pragma once
// One policy of culling and bias for every map, per caster; nothing for users to tune.
//
//   closed caster   only the faces turned away from the light are drawn: they lie behind every lit point of the
//                   caster, so that it cannot shade itself, and no bias is needed
//   open caster     both faces, pushed away from the light in proportion to their slope; the resolve compares at the
//                   texel's own place on the receiver's plane (shaders/shared/map_receiver.glsl)
//   inside out      as an open one: where the light is within, no face is wound away from it
//
// There is no constant bias. Its unit is the last place of the largest depth of the whole primitive (Vulkan, Depth Bias
// Computation), and where depths are clamped instead of clipped a triangle that reaches the plane through the light has
// no largest: with a factor of 2 an NVIDIA driver pushes it past the far end of the map. By how much coplanar sheets (a
// cloth on a table) are rounded apart is in what receivers allow for, DEPTH_ROUNDING (shaders/shared/map_lookup.h).
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Dynamic state of one caster's draw.
struct CasterRaster {
    VkCullModeFlags cullMode = VK_CULL_MODE_NONE;
    VkFrontFace frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    float slopeBias = 0.0f; ///< vkCmdSetDepthBias, third value; the first is 0.
};

/// Where two facets of an open surface meet in a valley, the plane of one runs below the other: at a texel's corner,
/// half a texel from the receiver in x and in y, by at most (|dz/dx| + |dz/dy|) / 2 <= max(|dz/dx|, |dz/dy|) of the
/// steeper one, which is what Vulkan multiplies with the slope factor.
inline constexpr float kOpenSlopeBias = 1.0f;

/// Projections keep the winding (LightFit), meshes are counter-clockwise seen from outside.
inline CasterRaster casterRaster(const Caster& caster, bool biasOpen = true)
{
    CasterRaster raster;
    raster.frontFace = caster.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE;
    if (caster.closed) raster.cullMode = VK_CULL_MODE_FRONT_BIT;
    if (!caster.closed && biasOpen) raster.slopeBias = kOpenSlopeBias;
    return raster;
}

} // namespace gnomon
