#include "demo/io/text.hpp"

#include "demo/io/font.hpp"

#include <algorithm>

namespace gnomon::demo {
namespace {

void drawGlyph(Image8& image, int32_t x, int32_t y, const Glyph& glyph, Rgb8 colour)
{
    for (uint32_t row = 0; row < glyph.height; ++row)
        for (uint32_t column = 0; column < glyph.width; ++column)
            if (const uint8_t coverage = glyph.coverage[row * glyph.width + column]; coverage > 0)
                tint(image, {x + int32_t(column), y + int32_t(row), 1, 1}, colour, float(coverage) / 255.0f);
}

} // namespace

TextSize measureText(std::string_view text, uint32_t scale)
{
    const Font& font = fontOf(scale);
    uint32_t pen = 0, widest = 0, lines = 1;
    for (const char c : text) {
        if (c == '\n') {
            pen = 0;
            ++lines;
            continue;
        }
        const Glyph& glyph = font[c];
        widest = std::max(widest, pen + glyph.left + glyph.width);
        pen += glyph.advance;
    }
    return {widest, (lines - 1) * font.lineAdvance + font.ascent + font.descent};
}

void drawText(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 colour, uint32_t scale)
{
    const Font& font = fontOf(scale);
    int32_t pen = x, baseline = y + int32_t(font.ascent);
    for (const char c : text) {
        if (c == '\n') {
            pen = x;
            baseline += int32_t(font.lineAdvance);
            continue;
        }
        const Glyph& glyph = font[c];
        drawGlyph(image, pen + int32_t(glyph.left), baseline - glyph.top, glyph, colour);
        pen += int32_t(glyph.advance);
    }
}

void drawLabel(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 ink, Rgb8 plate, uint32_t scale)
{
    const uint32_t margin = kLabelMargin * scale;
    const TextSize size = measureText(text, scale);
    fill(image, {x, y, size.width + 2 * margin, size.height + 2 * margin}, plate);
    drawText(image, x + int32_t(margin), y + int32_t(margin), text, ink, scale);
}

} // namespace gnomon::demo
