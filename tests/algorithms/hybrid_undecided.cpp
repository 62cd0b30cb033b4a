// Pixels that wait for their rays, found in a picture.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "algorithms/hybrid/undecided.hpp"
#include "shaders/hybrid/reasons.h"

using namespace gnomon;

namespace {

/// Pictures of which about one pixel in `one` is undecided, against a search byte by byte.
void check(std::uint32_t width, std::uint32_t height, std::uint32_t one, std::mt19937& random)
{
    constexpr std::uint32_t left = 300, top = 17;
    std::vector<std::uint8_t> bytes(std::size_t{width} * height);
    std::vector<std::uint32_t> wanted;
    for (std::uint32_t i = 0; i < bytes.size(); ++i) {
        const bool undecided = random() % one == 0;
        // Among the others those that differ in one bit, or are one more or less.
        constexpr std::uint8_t others[] = {0, 255, 72, 201, 199, 192, 204, 136, 1};
        bytes[i] = undecided ? std::uint8_t{gpu::UNDECIDED} : others[random() % std::size(others)];
        if (undecided) wanted.push_back(gpu::packPixel(left + i % width, top + i / width));
    }
    std::vector<std::uint32_t> found(wanted.size());
    REQUIRE(findUndecided(bytes, width, left, top, found) == wanted.size());
    const auto tileOf = [&](std::uint32_t pixel) {
        return (gpu::pixelY(pixel) - top) / 4 * 65536 + (gpu::pixelX(pixel) - left) / 4;
    };
    CHECK(std::is_sorted(found.begin(), found.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return tileOf(a) < tileOf(b); }));
    std::sort(found.begin(), found.end());
    std::sort(wanted.begin(), wanted.end());
    CHECK(found == wanted);
}

} // namespace

TEST_CASE("every undecided pixel is found once, tile by tile")
{
    std::mt19937 random(3);
    for (const std::uint32_t width : {1u, 4u, 7u, 8u, 15u, 37u, 64u})
        for (const std::uint32_t height : {1u, 3u, 4u, 21u})
            for (const std::uint32_t one : {1u, 2u, 9u, 200u})
                check(width, height, one, random);
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
