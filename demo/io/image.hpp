#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Pictures in memory. Row 0 is the top row in every one of them.
namespace gnomon::demo {

struct Rgb8 {
    uint8_t r = 0, g = 0, b = 0;
    bool operator==(const Rgb8&) const = default;
};

/// 8 bits a channel: 1 (gray) or 3 (RGB).
struct Image8 {
    uint32_t width = 0, height = 0, channels = 3;
    std::vector<uint8_t> texels;

    Image8() = default;
    Image8(uint32_t width, uint32_t height, uint32_t channels);

    uint8_t* at(uint32_t x, uint32_t y) { return &texels[(size_t(y) * width + x) * channels]; }
    const uint8_t* at(uint32_t x, uint32_t y) const { return &texels[(size_t(y) * width + x) * channels]; }
};

/// 32-bit float, 1 or 3 channels.
struct ImageF {
    uint32_t width = 0, height = 0, channels = 1;
    std::vector<float> texels;

    ImageF() = default;
    ImageF(uint32_t width, uint32_t height, uint32_t channels);

    float* at(uint32_t x, uint32_t y) { return &texels[(size_t(y) * width + x) * channels]; }
    const float* at(uint32_t x, uint32_t y) const { return &texels[(size_t(y) * width + x) * channels]; }
};

struct Rect {
    int32_t x = 0, y = 0;
    uint32_t width = 0, height = 0;
};

// All of these clip to the image; none fails.
Image8 toRgb(const Image8& image);
void fill(Image8& image, const Rect& where, Rgb8 colour);
void outline(Image8& image, const Rect& where, Rgb8 colour);              ///< One pixel wide, inside `where`.
void blit(Image8& target, int32_t x, int32_t y, const Image8& source);    ///< Gray is spread to RGB targets.
void tint(Image8& image, const Rect& where, Rgb8 colour, float strength); ///< strength 0 keeps, 1 replaces.

/// The part of `image` inside `where`, pixel for pixel; what lies outside the image is black.
Image8 crop(const Image8& image, const Rect& where);
/// Every pixel as a factor x factor square: shows aliasing without adding to it.
Image8 enlarge(const Image8& image, uint32_t factor);
/// Box-filtered to at most width x height, aspect kept; never enlarges.
Image8 shrinkToFit(const Image8& image, uint32_t width, uint32_t height);

/// Linear [0, 1] to sRGB, clamped; NaN gives 0.
uint8_t encodeSrgb(float linear) noexcept;

} // namespace gnomon::demo
