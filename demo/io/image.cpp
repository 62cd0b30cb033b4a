#include "demo/io/image.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::demo {
namespace {

/// Half-open pixel ranges.
struct Span2 {
    uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

Span2 clipped(const Image8& image, const Rect& rect)
{
    const auto clamp = [](int64_t value, uint32_t size) {
        return static_cast<uint32_t>(std::clamp<int64_t>(value, 0, size));
    };
    return {clamp(rect.x, image.width), clamp(rect.y, image.height), clamp(int64_t(rect.x) + rect.width, image.width),
            clamp(int64_t(rect.y) + rect.height, image.height)};
}

// Rec. 709 luma weights in 1/256, for colours drawn into gray images.
uint8_t luma(Rgb8 colour)
{
    return static_cast<uint8_t>((54u * colour.r + 183u * colour.g + 19u * colour.b) / 256u);
}

void put(uint8_t* texel, uint32_t channels, Rgb8 colour)
{
    if (channels == 1) {
        texel[0] = luma(colour);
        return;
    }
    texel[0] = colour.r;
    texel[1] = colour.g;
    texel[2] = colour.b;
}

Rgb8 get(const uint8_t* texel, uint32_t channels)
{
    return channels == 1 ? Rgb8{texel[0], texel[0], texel[0]} : Rgb8{texel[0], texel[1], texel[2]};
}

} // namespace

Image8::Image8(uint32_t w, uint32_t h, uint32_t c) : width(w), height(h), channels(c), texels(size_t(w) * h * c) {}

ImageF::ImageF(uint32_t w, uint32_t h, uint32_t c) : width(w), height(h), channels(c), texels(size_t(w) * h * c) {}

Image8 toRgb(const Image8& image)
{
    Image8 rgb(image.width, image.height, 3);
    blit(rgb, 0, 0, image);
    return rgb;
}

void fill(Image8& image, const Rect& where, Rgb8 colour)
{
    const Span2 span = clipped(image, where);
    for (uint32_t y = span.y0; y < span.y1; ++y)
        for (uint32_t x = span.x0; x < span.x1; ++x)
            put(image.at(x, y), image.channels, colour);
}

void outline(Image8& image, const Rect& where, Rgb8 colour)
{
    if (where.width == 0 || where.height == 0) return;
    const int32_t right = where.x + int32_t(where.width) - 1, bottom = where.y + int32_t(where.height) - 1;
    fill(image, {where.x, where.y, where.width, 1}, colour);
    fill(image, {where.x, bottom, where.width, 1}, colour);
    fill(image, {where.x, where.y, 1, where.height}, colour);
    fill(image, {right, where.y, 1, where.height}, colour);
}

void blit(Image8& target, int32_t x, int32_t y, const Image8& source)
{
    const Span2 span = clipped(target, {x, y, source.width, source.height});
    for (uint32_t ty = span.y0; ty < span.y1; ++ty)
        for (uint32_t tx = span.x0; tx < span.x1; ++tx) {
            const auto sx = static_cast<uint32_t>(int64_t(tx) - x), sy = static_cast<uint32_t>(int64_t(ty) - y);
            put(target.at(tx, ty), target.channels, get(source.at(sx, sy), source.channels));
        }
}

void tint(Image8& image, const Rect& where, Rgb8 colour, float strength)
{
    // 1/256 steps keep the picture the same on every machine. !(>) sends NaN to 0.
    const uint32_t share = !(strength > 0.0f) ? 0u : static_cast<uint32_t>(std::min(strength, 1.0f) * 256.0f + 0.5f);
    const auto mix = [share](uint8_t from, uint8_t to) {
        return static_cast<uint8_t>((from * (256u - share) + to * share) / 256u);
    };
    const Span2 span = clipped(image, where);
    for (uint32_t y = span.y0; y < span.y1; ++y)
        for (uint32_t x = span.x0; x < span.x1; ++x) {
            const Rgb8 old = get(image.at(x, y), image.channels);
            put(image.at(x, y), image.channels, {mix(old.r, colour.r), mix(old.g, colour.g), mix(old.b, colour.b)});
        }
}

Image8 crop(const Image8& image, const Rect& where)
{
    Image8 part(where.width, where.height, image.channels);
    blit(part, -where.x, -where.y, image);
    return part;
}

Image8 enlarge(const Image8& image, uint32_t factor)
{
    Image8 big(image.width * factor, image.height * factor, image.channels);
    for (uint32_t y = 0; y < big.height; ++y)
        for (uint32_t x = 0; x < big.width; ++x)
            std::copy_n(image.at(x / factor, y / factor), image.channels, big.at(x, y));
    return big;
}

Image8 shrinkToFit(const Image8& image, uint32_t width, uint32_t height)
{
    if (image.width == 0 || image.height == 0) return {};
    const double factor = std::min({1.0, double(width) / image.width, double(height) / image.height});
    const auto size = [factor](uint32_t n) { return std::max(1u, static_cast<uint32_t>(std::floor(n * factor))); };
    Image8 small(size(image.width), size(image.height), image.channels);
    for (uint32_t y = 0; y < small.height; ++y)
        for (uint32_t x = 0; x < small.width; ++x) {
            const auto edge = [](uint32_t i, uint32_t from, uint32_t to) {
                return static_cast<uint32_t>(uint64_t(i) * from / to);
            };
            const uint32_t x0 = edge(x, image.width, small.width), x1 = edge(x + 1, image.width, small.width);
            const uint32_t y0 = edge(y, image.height, small.height), y1 = edge(y + 1, image.height, small.height);
            const uint32_t count = (x1 - x0) * (y1 - y0);
            for (uint32_t c = 0; c < image.channels; ++c) {
                uint32_t sum = count / 2; // rounds to nearest
                for (uint32_t sy = y0; sy < y1; ++sy)
                    for (uint32_t sx = x0; sx < x1; ++sx)
                        sum += image.at(sx, sy)[c];
                small.at(x, y)[c] = static_cast<uint8_t>(sum / count);
            }
        }
    return small;
}

uint8_t encodeSrgb(float linear) noexcept
{
    if (!(linear > 0.0f)) return 0; // NaN too
    if (linear >= 1.0f) return 255;
    // IEC 61966-2-1.
    const float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
    return static_cast<uint8_t>(encoded * 255.0f + 0.5f);
}

} // namespace gnomon::demo
