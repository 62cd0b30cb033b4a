// Lists of pixels in the order the ray tracer likes.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "algorithms/hybrid/pixel_list.hpp"
#include "shaders/hybrid/ray_list.h"

using namespace gnomon;

TEST_CASE("tile order holds the same pixels, tile by tile, whatever order the GPU made")
{
    constexpr VkExtent2D extent{37, 21}; // neither side a multiple of the tile
    std::mt19937 random(3);
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t y = 0; y < extent.height; ++y) {
        for (std::uint32_t x = 0; x < extent.width; ++x) {
            if (random() % 3) pixels.push_back(gpu::packPixel(x, y));
        }
    }
    std::shuffle(pixels.begin(), pixels.end(), random);
    FrameArena arena;
    const auto sorted = inTileOrder(pixels, extent, arena);
    REQUIRE(sorted.size() == pixels.size());
    const auto tileOf = [&](std::uint32_t pixel) { return gpu::pixelY(pixel) / 4 * 10 + gpu::pixelX(pixel) / 4; };
    CHECK(std::is_sorted(sorted.begin(), sorted.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return tileOf(a) < tileOf(b); }));
    std::vector<std::uint32_t> left(pixels), right(sorted.begin(), sorted.end());
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    CHECK(left == right);
    CHECK(inTileOrder({}, extent, arena).empty());
}

TEST_CASE("a packed pixel keeps both coordinates up to 65535")
{
    for (const std::uint32_t x : {0u, 1u, 16384u, 65535u}) {
        for (const std::uint32_t y : {0u, 7u, 65535u}) {
            CHECK(gpu::pixelX(gpu::packPixel(x, y)) == x);
            CHECK(gpu::pixelY(gpu::packPixel(x, y)) == y);
        }
    }
}
