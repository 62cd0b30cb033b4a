#pragma once
// How dense the outlines of a light's shadows are where a view sees them, by shadow rays.
#include <optional>
#include <span>

#include "runtime/rays/ray_scene.hpp"
#include "runtime/select/facts.hpp"

namespace gnomon {

/// Whether rays meet all of a light's casters, and no host is asked what they meet.
bool raysTellOutlines(const LightCasters& casters);

/// Rays go to the light from four places of a tile, as those of ray-traced shadows do. An outline lies between two of
/// them if one is in shadow and the other is not. What faces away from the light has none.
/// @param rays brought to the frame's casters
/// @return the mean over `tiles`; nothing where there are none, or the view has no perspective
std::optional<ShadowOutlines> outlinesByRays(const CameraView& view, const LightView& light,
                                             std::span<const TileSample::Tile> tiles, const RayScene& rays);

} // namespace gnomon
