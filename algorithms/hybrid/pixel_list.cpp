#include "algorithms/hybrid/pixel_list.hpp"

#include <algorithm>

#include "shaders/hybrid/ray_list.h"

namespace gnomon {

std::span<const std::uint32_t> inTileOrder(std::span<const std::uint32_t> pixels, VkExtent2D extent, FrameArena& arena)
{
    constexpr std::uint32_t tile = 4;
    const std::size_t columns = (extent.width + tile - 1) / tile, rows = (extent.height + tile - 1) / tile;
    const auto tileOf = [&](std::uint32_t pixel) {
        return gpu::pixelY(pixel) / tile * columns + gpu::pixelX(pixel) / tile;
    };
    // Counting sort: counts, their running sum, then every pixel to its place.
    const std::span<std::uint32_t> next = arena.array<std::uint32_t>(columns * rows + 1);
    std::fill(next.begin(), next.end(), 0u);
    for (const std::uint32_t pixel : pixels)
        ++next[tileOf(pixel) + 1];
    for (std::size_t i = 1; i < next.size(); ++i)
        next[i] += next[i - 1];
    const std::span<std::uint32_t> sorted = arena.array<std::uint32_t>(pixels.size());
    for (const std::uint32_t pixel : pixels)
        sorted[next[tileOf(pixel)]++] = pixel;
    return sorted;
}

} // namespace gnomon
