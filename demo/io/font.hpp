#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

/// Characters as coverage. Sizes are counted in steps, the `scale` of captions, so that both fonts take about as much
/// room.
namespace gnomon::demo {

/// Rows from the top, placed from the pen, which stands on the baseline.
struct Glyph {
    uint32_t left = 0; ///< Pixels from the pen to the first column.
    int32_t top = 0;   ///< Pixels from the baseline up to the first row.
    uint32_t width = 0, height = 0;
    uint32_t advance = 0;          ///< Pixels to the next pen.
    std::vector<uint8_t> coverage; ///< 255 is ink.
};

/// Printable ASCII at one size.
struct Font {
    static constexpr char kFirst = ' ', kLast = '~';
    uint32_t ascent = 0, descent = 0;             ///< Pixels above and below the baseline that any glyph takes.
    uint32_t lineAdvance = 0;                     ///< Pixels from baseline to baseline.
    std::array<Glyph, kLast - kFirst + 2> glyphs; ///< The last one stands for everything else.

    const Glyph& operator[](char character) const noexcept;
};

/// Pixels of an outline font's em for each step of `scale`: the least at which hinted DejaVu Sans reads well.
inline constexpr uint32_t kEmPixels = 12;

/// 5 x 7 dots of `scale` pixels.
Font dotFont(uint32_t scale);
/// fontFile() by FreeType; nothing where the build has no FreeType or the file cannot be read.
std::optional<Font> outlineFont(uint32_t scale);
/// DejaVu Sans, where the build found it; empty without FreeType.
const char* fontFile() noexcept;

/// The outline font, or else the dots; kept from the first call on. From one thread. \param scale >= 1
const Font& fontOf(uint32_t scale);

} // namespace gnomon::demo
