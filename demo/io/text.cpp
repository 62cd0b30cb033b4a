#include "demo/io/text.hpp"

#include "demo/io/font.hpp"

#include <algorithm>

namespace gnomon::demo {
namespace {

constexpr uint32_t kAdvance = kGlyphWidth + 1, kLineAdvance = kGlyphHeight + 2; // dots

} // namespace

TextSize measureText(std::string_view text, uint32_t scale) noexcept
{
    uint32_t columns = 0, widest = 0, lines = 1;
    for (const char c : text) {
        columns = c == '\n' ? 0 : columns + 1;
        lines += c == '\n';
        widest = std::max(widest, columns);
    }
    if (widest == 0) return {0, (lines * kLineAdvance - 2) * scale};
    return {(widest * kAdvance - 1) * scale, (lines * kLineAdvance - 2) * scale};
}

void drawText(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 colour, uint32_t scale)
{
    const auto dot = static_cast<int32_t>(scale);
    int32_t left = x, top = y;
    for (const char c : text) {
        if (c == '\n') {
            left = x;
            top += dot * int32_t(kLineAdvance);
            continue;
        }
        const Glyph& glyph = glyphOf(c);
        for (int32_t row = 0; row < int32_t(kGlyphHeight); ++row)
            for (int32_t column = 0; column < int32_t(kGlyphWidth); ++column)
                if (glyph[size_t(row)] >> (kGlyphWidth - 1 - column) & 1)
                    fill(image, {left + column * dot, top + row * dot, scale, scale}, colour);
        left += dot * int32_t(kAdvance);
    }
}

void drawLabel(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 ink, Rgb8 plate, uint32_t scale)
{
    const uint32_t margin = 2 * scale;
    const TextSize size = measureText(text, scale);
    fill(image, {x, y, size.width + 2 * margin, size.height + 2 * margin}, plate);
    drawText(image, x + int32_t(margin), y + int32_t(margin), text, ink, scale);
}

} // namespace gnomon::demo
