#include "algorithms/hybrid/coherence_tile.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

namespace gnomon {

namespace {

constexpr std::uint8_t kLit = 255, kDark = 0;

// Neighbours are one surface if their normals are within 37 degrees and either lies within two footprints of a pixel of
// the other's plane: facets of a sphere of 20 by 10 turn by 18 degrees, steps and silhouettes are farther apart.
constexpr float kAlikeCosine = 0.8f, kAlikeFootprints = 2.0f;

} // namespace

void CoherenceTile::read(const Receivers& receivers, std::uint32_t left, std::uint32_t top,
                         std::span<std::uint8_t> visibility, std::size_t stride)
{
    glm::vec3 across(0.0f);
    for (std::uint32_t y = 0; y < height_; ++y) {
        for (std::uint32_t x = 0; x < width_; ++x) {
            Pixel& pixel = at(x, y);
            const Asked asked = receivers.at(left + x, top + y, pixel.centre, pixel.surface);
            visibility[y * stride + x] = asked == Asked::lit ? kLit : kDark;
            pixel.asks = asked == Asked::ray;
            if (!pixel.asks) continue;
            if (across == glm::vec3(0.0f)) across = axisAcross(pixel.centre.direction);
            pixel.disc = LightDisc(pixel.centre.direction, across, light_.radius);
            pixel.cells = {};
        }
    }
}

bool CoherenceTile::alike(const Pixel& pixel, const Pixel& other) const
{
    if (!pixel.asks || !other.asks || glm::dot(pixel.surface.normal, other.surface.normal) < kAlikeCosine) return false;
    const glm::vec3 apart = other.centre.origin - pixel.centre.origin;
    const float off =
        std::fmin(std::fabs(glm::dot(pixel.surface.normal, apart)), std::fabs(glm::dot(other.surface.normal, apart)));
    return off <= kAlikeFootprints * light_.pixelSize * std::fmin(pixel.surface.w, other.surface.w);
}

void CoherenceTile::findAlike()
{
    for (std::uint32_t y = 0; y < height_; ++y)
        for (std::uint32_t x = 0; x < width_; ++x)
            at(x, y).beside = 0;
    for (std::uint32_t y = 0; y < height_; ++y) {
        for (std::uint32_t x = 0; x < width_; ++x) {
            Pixel& pixel = at(x, y);
            if (x + 1 < width_ && alike(pixel, at(x + 1, y))) {
                pixel.beside |= kRight;
                at(x + 1, y).beside |= kLeft;
            }
            if (y + 1 < height_ && alike(pixel, at(x, y + 1))) {
                pixel.beside |= kBelow;
                at(x, y + 1).beside |= kAbove;
            }
        }
    }
}

/// Adds rays to the batch; their tags are those of `tag` * kCells and up.
void CoherenceTile::ask(const Pixel& pixel, CellMask cells, std::uint32_t tag)
{
    for (; cells != 0; cells &= cells - 1) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(cells));
        batch_.rays[batch_.count] = pixel.disc.ray(pixel.centre, light_.grid.at(bit));
        batch_.tags[batch_.count++] = tag * kCells + bit;
    }
}

/// Some cells of every pixel's rim, other ones from pixel to pixel: what comes before the light comes over its rim.
/// They depend on no neighbour, so that the rays of a tile share their packets.
void CoherenceTile::askRims(std::uint32_t left, std::uint32_t top)
{
    const auto answer = [&](std::uint32_t tag, bool occluded) {
        if (!occluded) pixels_[tag / kCells].cells.seen |= CellMask{1} << tag % kCells;
    };
    for (std::uint32_t y = 0; y < height_; ++y) {
        for (std::uint32_t x = 0; x < width_; ++x) {
            Pixel& pixel = at(x, y);
            if (!pixel.asks) continue;
            // Of fourteen sets any 5 x 3 pixels hold them all. Where one side is not looked at by a neighbour, such as
            // on the tile's own rim, a pixel looks at four times as many: of 120 pixels missed of 24 842 most were
            // there.
            const std::uint32_t first = left + x + 5 * (top + y);
            for (std::uint32_t set = 0; set < (pixel.beside == kAround ? 1u : 4u); ++set)
                pixel.cells.known |= light_.grid.rim(first + 4 * set);
            ask(pixel, pixel.cells.known, y * kSide + x);
            if (batch_.count + kCells > kBatch) batch_.flush(host_, light_.mask, answer);
        }
    }
    batch_.flush(host_, light_.mask, answer);
}

/// On the way forward: what is seen from the left, or from above, is believed to be seen from here. @return what it
/// doubts.
CellMask CoherenceTile::predict(Pixel& pixel) const
{
    const CellMask left = pixel.beside & kLeft ? (&pixel - 1)->cells.seen : 0;
    const CellMask above = pixel.beside & kAbove ? (&pixel - kSide)->cells.seen : 0;
    if (!(pixel.beside & (kLeft | kAbove))) return light_.grid.all();
    pixel.cells.seen |= (pixel.beside & kLeft ? left : above) & ~pixel.cells.known;
    return (pixel.beside & kLeft) && (pixel.beside & kAbove) ? left ^ above : 0;
}

/// On the way back: what any neighbour has found out otherwise is doubted.
CellMask CoherenceTile::review(const Pixel& pixel) const
{
    constexpr std::ptrdiff_t row = kSide;
    constexpr std::pair<Side, std::ptrdiff_t> sides[] = {{kLeft, -1}, {kRight, 1}, {kAbove, -row}, {kBelow, row}};
    CellMask doubted = 0;
    for (const auto& [side, way] : sides)
        if (pixel.beside & side) doubted |= pixel.cells.seen ^ (&pixel + way)->cells.seen;
    return doubted;
}

/// Adds what the pixels ask next to the batch. @return those that do.
std::span<CoherenceTile::Following> CoherenceTile::askNext(std::span<Following> pixels)
{
    std::size_t kept = 0;
    for (Following& following : pixels) {
        const Pixel& pixel = *following.pixel;
        following.asked = pixel.cells.next(light_.grid, following.doubted);
        if (following.asked == 0) continue;
        ask(pixel, following.asked, static_cast<std::uint32_t>(kept));
        pixels[kept++] = following;
    }
    return pixels.first(kept);
}

void CoherenceTile::follow(std::span<Following> pixels)
{
    while (!(pixels = askNext(pixels)).empty()) {
        CellMask answers[kSide] = {};
        batch_.flush(host_, light_.mask, [&](std::uint32_t tag, bool occluded) {
            if (!occluded) answers[tag / kCells] |= CellMask{1} << tag % kCells;
        });
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i].pixel->cells.learn(pixels[i].asked, answers[i]);
    }
}

/// The pixels with x + y = diagonal know nothing of each other, so that their rays share packets.
template <typename Doubt>
void CoherenceTile::sweep(std::uint32_t diagonal, Doubt doubt)
{
    std::size_t count = 0;
    for (std::uint32_t y = diagonal < width_ ? 0 : diagonal - width_ + 1; y < height_ && y <= diagonal; ++y) {
        Pixel& pixel = at(diagonal - y, y);
        if (pixel.asks) following_[count++] = {&pixel, doubt(pixel), 0};
    }
    follow({following_, count});
}

void CoherenceTile::answer(const Receivers& receivers, std::uint32_t left, std::uint32_t top, std::uint32_t width,
                           std::uint32_t height, std::span<std::uint8_t> visibility, std::size_t stride)
{
    width_ = width;
    height_ = height;
    read(receivers, left, top, visibility, stride);
    findAlike();
    askRims(left, top);
    const std::uint32_t diagonals = width + height - 1;
    for (std::uint32_t d = 0; d < diagonals; ++d)
        sweep(d, [this](Pixel& pixel) { return predict(pixel); });
    for (std::uint32_t d = diagonals; d-- > 0;)
        sweep(d, [this](Pixel& pixel) { return review(pixel); });
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            if (const Pixel& pixel = at(x, y); pixel.asks)
                visibility[y * stride + x] =
                    static_cast<std::uint8_t>(std::lround(255.0f * light_.grid.share(pixel.cells.seen)));
}

} // namespace gnomon
