#include "demo/io/font.hpp"

#include <algorithm>
#include <memory>

#include <ft2build.h>
#include FT_FREETYPE_H

namespace gnomon::demo {
namespace {

using Library = std::unique_ptr<FT_LibraryRec_, decltype(&FT_Done_FreeType)>;
using Face = std::unique_ptr<FT_FaceRec_, decltype(&FT_Done_Face)>;

/// \pre The face's slot holds a rendered glyph.
Glyph glyphIn(const FT_GlyphSlot slot)
{
    const FT_Bitmap& bitmap = slot->bitmap;
    // A glyph that reaches back over its pen (j) is moved: a text stays inside the box that it was measured to have.
    Glyph glyph{.left = uint32_t(std::max(slot->bitmap_left, 0)),
                .top = slot->bitmap_top,
                .width = bitmap.width,
                .height = bitmap.rows,
                .advance = uint32_t(slot->advance.x >> 6),
                .coverage = {}};
    for (uint32_t row = 0; row < bitmap.rows; ++row) {
        const uint8_t* const texels = bitmap.buffer + ptrdiff_t(row) * bitmap.pitch;
        glyph.coverage.insert(glyph.coverage.end(), texels, texels + bitmap.width);
    }
    return glyph;
}

} // namespace

const char* fontFile() noexcept
{
    return GNOMON_FONT_FILE;
}

std::optional<Font> outlineFont(uint32_t scale)
{
    FT_Library opened = nullptr;
    if (FT_Init_FreeType(&opened) != 0) return std::nullopt;
    const Library library(opened, &FT_Done_FreeType);
    FT_Face read = nullptr;
    if (FT_New_Face(library.get(), fontFile(), 0, &read) != 0) return std::nullopt;
    const Face face(read, &FT_Done_Face);
    if (FT_Set_Pixel_Sizes(face.get(), 0, kEmPixels * scale) != 0) return std::nullopt;

    Font font;
    for (size_t i = 0; i < font.glyphs.size(); ++i) {
        const bool last = i + 1 == font.glyphs.size(); // glyph 0 of a face stands for what it lacks
        const FT_UInt index = last ? 0 : FT_Get_Char_Index(face.get(), FT_ULong(Font::kFirst) + i);
        // Light hinting moves outlines to whole rows only: advances stay as they were drawn.
        if (FT_Load_Glyph(face.get(), index, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) != 0) return std::nullopt;
        if (face->glyph->bitmap.pixel_mode != FT_PIXEL_MODE_GRAY && face->glyph->bitmap.rows > 0) return std::nullopt;
        font.glyphs[i] = glyphIn(face->glyph);
        font.ascent = std::max(font.ascent, uint32_t(std::max(font.glyphs[i].top, 0)));
        font.descent =
            std::max(font.descent, uint32_t(std::max(int32_t(font.glyphs[i].height) - font.glyphs[i].top, 0)));
    }
    font.lineAdvance = font.ascent + font.descent + scale;
    return font;
}

} // namespace gnomon::demo
