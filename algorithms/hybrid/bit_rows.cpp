#include "algorithms/hybrid/bit_rows.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gnomon {

namespace {

/// Bit 0 of eight bytes, the first in bit 0.
std::uint64_t gatherBits(const std::uint8_t* bytes)
{
    std::uint64_t eight = 0;
    if constexpr (std::endian::native == std::endian::little) {
        std::memcpy(&eight, bytes, 8);
    } else {
        for (int i = 0; i < 8; ++i)
            eight |= std::uint64_t{bytes[i]} << (8 * i);
    }
    // Byte i has its bit at 8 i. The multiplication adds shifts by 56 - 7 i: it lands at 56 + i, and no two of the sums
    // below meet there.
    return ((eight & 0x0101010101010101ull) * 0x0102040810204080ull) >> 56;
}

/// Every bit of the word, and of what the row has beside it: towards smaller x and towards larger.
std::uint64_t fromLeft(std::span<const std::uint64_t> row, std::size_t i)
{
    return row[i] << 1 | (i > 0 ? row[i - 1] >> 63 : 0);
}
std::uint64_t fromRight(std::span<const std::uint64_t> row, std::size_t i)
{
    return row[i] >> 1 | (i + 1 < row.size() ? row[i + 1] << 63 : 0);
}

/// Bits of the word that are pixels.
std::uint64_t inside(std::uint32_t width, std::size_t word)
{
    const std::size_t first = 64 * word;
    return width >= first + 64 ? ~0ull : ~(~0ull << (width - first));
}

/// Adds the pixels of row y that differ from a neighbour.
void addBoundary(const BitRows& bits, std::uint32_t y, std::span<std::uint64_t> marks)
{
    const std::span<const std::uint64_t> row = bits.row(y);
    const std::span<const std::uint64_t> above = bits.row(y > 0 ? y - 1 : y);
    const std::span<const std::uint64_t> below = bits.row(y + 1 < bits.height ? y + 1 : y);
    const std::size_t last = (bits.width - 1) / 64;
    const std::uint64_t lastBit = 1ull << ((bits.width - 1) % 64);
    for (std::size_t i = 0; i < row.size(); ++i) {
        std::uint64_t left = row[i] ^ fromLeft(row, i), right = row[i] ^ fromRight(row, i);
        if (i == 0) left &= ~1ull;
        if (i == last) right &= ~lastBit;
        marks[i] |= (left | right | (row[i] ^ above[i]) | (row[i] ^ below[i])) & inside(bits.width, i);
    }
}

void widen(std::uint32_t width, std::span<std::uint64_t> row)
{
    std::uint64_t before = 0; // the word to the left, as it was
    for (std::size_t i = 0; i < row.size(); ++i) {
        const std::uint64_t word = row[i];
        row[i] = (word | word << 1 | before >> 63 | fromRight(row, i)) & inside(width, i);
        before = word;
    }
}

} // namespace

void packBits(std::span<const std::uint8_t> bytes, std::span<std::uint64_t> row)
{
    std::fill(row.begin(), row.end(), std::uint64_t{0});
    std::size_t x = 0;
    for (; x + 8 <= bytes.size(); x += 8)
        row[x / 64] |= gatherBits(bytes.data() + x) << (x % 64);
    for (; x < bytes.size(); ++x)
        row[x / 64] |= std::uint64_t{bytes[x] & 1u} << (x % 64);
}

void contourRow(const BitRows& bits, std::uint32_t y, std::uint32_t radius, std::span<std::uint64_t> contour)
{
    std::fill(contour.begin(), contour.end(), std::uint64_t{0});
    addBoundary(bits, y, contour);
    for (std::uint32_t step = 1; step <= radius; ++step) {
        widen(bits.width, contour);
        if (y >= step) addBoundary(bits, y - step, contour);
        if (y + step < bits.height) addBoundary(bits, y + step, contour);
    }
}

void fullRow(std::uint32_t width, std::span<std::uint64_t> row)
{
    for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = inside(width, i);
}

std::size_t countBits(std::span<const std::uint64_t> words)
{
    std::size_t count = 0;
    for (const std::uint64_t word : words)
        count += static_cast<std::size_t>(std::popcount(word));
    return count;
}

} // namespace gnomon
