#pragma once

#include "demo/io/image.hpp"

#include <string_view>

/// Captions: a 5 x 7 dot font, printable ASCII, six dots from letter to letter and nine from line to line.
namespace gnomon::demo {

struct TextSize {
    uint32_t width = 0, height = 0;
};

/// \param scale Pixels per dot, >= 1. A newline starts a line; what is not printable shows as a box.
TextSize measureText(std::string_view text, uint32_t scale = 1) noexcept;
void drawText(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 colour, uint32_t scale = 1);
/// The same on a filled plate that leaves `scale` * 2 pixels around it; x, y is the plate's corner.
void drawLabel(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 ink, Rgb8 plate, uint32_t scale = 1);

} // namespace gnomon::demo
