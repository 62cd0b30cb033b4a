#pragma once
// Lists of pixels that fragment shaders made by atomicAdd, on the CPU.
#include <cstdint>
#include <span>

#include "runtime/core/arena.hpp"
#include "runtime/passes/pass_builder.hpp"

namespace gnomon {

/// The same pixels in tiles of 4x4, tiles row by row: neighbours side by side for the ray tracer, and an order that
/// does not depend on the GPU's. Within a tile the order is the list's. Memory from the arena.
/// @param pixels packed by packPixel() (shaders/hybrid/ray_list.h), inside the extent.
std::span<const std::uint32_t> inTileOrder(std::span<const std::uint32_t> pixels, VkExtent2D extent, FrameArena& arena);

} // namespace gnomon
