#pragma once
// Pictures of one bit a pixel, 64 pixels a word, and the contour of what is set in them.
#include <cstddef>
#include <cstdint>
#include <span>

namespace gnomon {

/// Bit x % 64 of word x / 64 of a row is pixel x; bits past the width are 0.
struct BitRows {
    std::uint32_t width = 0, height = 0;
    std::span<std::uint64_t> words; ///< wordsPerRow() * height; the memory is somebody else's.

    static std::size_t wordsPerRow(std::uint32_t width) { return (std::size_t{width} + 63) / 64; }
    std::span<std::uint64_t> row(std::uint32_t y) const
    {
        return words.subspan(y * wordsPerRow(width), wordsPerRow(width));
    }
    bool at(std::uint32_t x, std::uint32_t y) const { return (row(y)[x / 64] >> (x % 64) & 1) != 0; }
};

/// A row from bytes: bit 0 of each.
void packBits(std::span<const std::uint8_t> bytes, std::span<std::uint64_t> row);

/// The pixels of row y that are at most `radius` steps, in x or in y, from a change: radius 0 marks the pixels that
/// differ from one of their four neighbours (both sides of a border, two pixels wide), each further step adds a pixel
/// on either side. What lies outside the picture differs from nobody.
///
/// Source: Moderno, 3.1.2, his contours of 2, 4 and 6 pixels. He does not say how he dilates; by steps in x or in y a
/// straight edge of any direction has twice and three times the pixels of two, as in his tables (trees 1.97 and 2.92);
/// by 3x3 a diagonal one would have three and five times as many.
void contourRow(const BitRows& bits, std::uint32_t y, std::uint32_t radius, std::span<std::uint64_t> contour);

/// All pixels of a row.
void fullRow(std::uint32_t width, std::span<std::uint64_t> row);

/// Set bits.
std::size_t countBits(std::span<const std::uint64_t> words);

} // namespace gnomon
