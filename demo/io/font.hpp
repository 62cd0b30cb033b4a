#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gnomon::demo {

inline constexpr uint32_t kGlyphWidth = 5, kGlyphHeight = 7;

/// Seven rows from the top; bit 4 is the leftmost dot.
using Glyph = std::array<uint8_t, kGlyphHeight>;

/// The glyph of a printable ASCII character; a hollow box for anything else.
const Glyph& glyphOf(char character) noexcept;

} // namespace gnomon::demo
