#pragma once

#include "demo/io/image.hpp"

#include <string_view>

/// Captions in the font of font.hpp, printable ASCII.
namespace gnomon::demo {

struct TextSize {
    uint32_t width = 0, height = 0;
};

inline constexpr uint32_t kLabelMargin = 2; ///< Pixels of plate round a label, times its scale.

/// \param scale Size of the letters, >= 1: fontOf(). A newline starts a line; what is not printable shows as a box.
TextSize measureText(std::string_view text, uint32_t scale = 1);
void drawText(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 colour, uint32_t scale = 1);
/// The same on a filled plate; x, y is the plate's corner.
void drawLabel(Image8& image, int32_t x, int32_t y, std::string_view text, Rgb8 ink, Rgb8 plate, uint32_t scale = 1);

} // namespace gnomon::demo
