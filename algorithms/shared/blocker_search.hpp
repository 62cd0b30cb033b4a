#pragma once
// The cone from a receiver to a light's disc as the light's map shows it: for shaders/shared/blocker_search.glsl.
#include <algorithm>
#include <cstdint>

#include "algorithms/shared/depth_map.hpp"
#include "shaders/shared/blocker_search.h"

namespace gnomon {

/// Whether the light has a penumbra.
inline bool isSoft(const LightView& light)
{
    return light.constants.sourceRadius > 0.0f;
}

/// Texels around what a map has to cover: penumbrae reach past it. A sixteenth of the side is an eighth of the distance
/// where the map is 90 degrees wide; taps beyond take the outermost texel.
inline std::uint32_t softBorder(std::uint32_t resolution)
{
    return std::clamp(resolution / 16, kMapBorderTexels, 255u); // below 2^8: borderForm()
}

/// @param fit of any layer of the map: all have the same texels. look: with addLightProjection()
gpu::DiscCone discCone(const LightView& light, const LightFit& fit, const gpu::MapLookup& look);

} // namespace gnomon
