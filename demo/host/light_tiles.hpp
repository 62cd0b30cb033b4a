#pragma once
// Which lights can reach which part of the screen, so that the lighting pass leaves out the others of a street.

#include <span>

#include "demo/host/geometry.hpp"
#include "shaders/demo/frame.h"

namespace gnomon::demo {

/// Pixels of a tile: the screen has LIGHT_TILES of them a side, whatever its size.
VkExtent2D lightTileSize(VkExtent2D extent);

/// Sets in every tile the bits of the lights that may reach a pixel of it, and of no others as far as their spheres of
/// range tell. \param masks LIGHT_TILES x LIGHT_TILES x LIGHT_TILE_WORDS, row by row, cleared by the caller.
void markLightTiles(const CameraMatrices& camera, VkExtent2D extent, std::span<const gpu::DemoLight> lights,
                    std::span<uint32_t> masks);

} // namespace gnomon::demo
