// Bit rows and contours against the same said pixel by pixel.
#include <doctest/doctest.h>

#include <cstdlib>
#include <random>
#include <vector>

#include "algorithms/hybrid/bit_rows.hpp"

using namespace gnomon;

namespace {

struct Picture {
    std::uint32_t width, height;
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint64_t> words;

    Picture(std::uint32_t w, std::uint32_t h) : width(w), height(h), bytes(std::size_t{w} * h)
    {
        words.resize(BitRows::wordsPerRow(w) * h);
    }
    BitRows bits()
    {
        const BitRows rows{width, height, words};
        for (std::uint32_t y = 0; y < height; ++y)
            packBits(std::span<const std::uint8_t>(bytes).subspan(std::size_t{y} * width, width), rows.row(y));
        return rows;
    }
    bool at(int x, int y) const { return (bytes[std::size_t(y) * width + std::size_t(x)] & 1) != 0; }
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < int(width) && y < int(height); }
    bool border(int x, int y) const
    {
        for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}})
            if (inside(x + dx, y + dy) && at(x + dx, y + dy) != at(x, y)) return true;
        return false;
    }
    bool nearBorder(int x, int y, int radius) const
    {
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx)
                if (std::abs(dx) + std::abs(dy) <= radius && inside(x + dx, y + dy) && border(x + dx, y + dy))
                    return true;
        return false;
    }
};

/// Blobs, single pixels and all bytes whose lowest bit counts.
Picture randomPicture(std::uint32_t width, std::uint32_t height, std::mt19937& random)
{
    Picture picture(width, height);
    std::uniform_int_distribution<int> byte(0, 255), rare(0, 60);
    int value = byte(random);
    for (std::uint8_t& b : picture.bytes) {
        if (rare(random) == 0) value = byte(random);
        b = static_cast<std::uint8_t>(value);
    }
    return picture;
}

} // namespace

TEST_CASE("a contour is what lies near a change, whatever the width of the picture")
{
    std::mt19937 random(5);
    for (const std::uint32_t width : {1u, 7u, 63u, 64u, 65u, 130u}) {
        for (const std::uint32_t height : {1u, 2u, 9u}) {
            Picture picture = randomPicture(width, height, random);
            const BitRows bits = picture.bits();
            std::vector<std::uint64_t> row(BitRows::wordsPerRow(width));
            for (const std::uint32_t radius : {0u, 1u, 2u}) {
                int wrong = 0;
                std::size_t expected = 0, found = 0;
                for (std::uint32_t y = 0; y < height; ++y) {
                    contourRow(bits, y, radius, row);
                    found += countBits(row);
                    for (std::uint32_t x = 0; x < width; ++x) {
                        const bool near = picture.nearBorder(int(x), int(y), int(radius));
                        expected += near;
                        wrong += near != ((row[x / 64] >> (x % 64) & 1) != 0);
                        wrong += bits.at(x, y) != picture.at(int(x), int(y));
                    }
                }
                CHECK(wrong == 0);
                CHECK(found == expected); // nothing beyond the width
            }
        }
    }
}

TEST_CASE("a full row has exactly the pixels of the picture")
{
    for (const std::uint32_t width : {1u, 63u, 64u, 65u, 128u, 1280u}) {
        std::vector<std::uint64_t> row(BitRows::wordsPerRow(width));
        fullRow(width, row);
        CHECK(countBits(row) == width);
    }
}
