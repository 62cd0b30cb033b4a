#include "algorithms/hybrid/coherence_tile.hpp"

#include <cmath>

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
            pixel.seen = pixel.known = 0;
        }
    }
}

CellMask CoherenceTile::ask(const Pixel& pixel, CellMask cells)
{
    ShadowRay rays[64];
    std::uint8_t occluded[64];
    std::size_t count = 0;
    for (CellMask left = cells; left != 0; left &= left - 1)
        rays[count++] = pixel.disc.ray(pixel.centre, light_.grid.at(static_cast<std::uint32_t>(std::countr_zero(left))));
    host_.rays->occluded({rays, count}, light_.mask, RayCoherence::tiles, {occluded, count});
    rays_ += count;
    CellMask seen = 0;
    count = 0;
    for (CellMask left = cells; left != 0; left &= left - 1)
        if (!occluded[count++]) seen |= left & -left;
    return seen;
}

/// Some cells of every pixel's rim, other ones from pixel to pixel: what comes before the light comes over its rim.
/// They depend on no neighbour, so that the rays of a tile share their packets.
void CoherenceTile::askRims(std::uint32_t left, std::uint32_t top)
{
    RayBatch<256> batch;
    const auto answer = [&](std::uint32_t tag, bool occluded) {
        if (!occluded) pixels_[tag / 64].seen |= CellMask{1} << tag % 64;
    };
    for (std::uint32_t y = 0; y < height_; ++y) {
        for (std::uint32_t x = 0; x < width_; ++x) {
            Pixel& pixel = at(x, y);
            if (!pixel.asks) continue;
            // Three apart from row to row: of seven sets any 3 x 3 pixels hold them all.
            pixel.known = light_.grid.rim(left + x + 3 * (top + y));
            for (CellMask cells = pixel.known; cells != 0; cells &= cells - 1) {
                const auto bit = static_cast<std::uint32_t>(std::countr_zero(cells));
                batch.rays[batch.count] = pixel.disc.ray(pixel.centre, light_.grid.at(bit));
                batch.tags[batch.count++] = (y * kSide + x) * 64 + bit;
                if (batch.full()) batch.flush(host_, light_.mask, RayCoherence::tiles, answer);
            }
        }
    }
    batch.flush(host_, light_.mask, RayCoherence::tiles, answer);
}

/// The neighbour there, if it asks and lies on the same surface; else null.
const CoherenceTile::Pixel* CoherenceTile::alike(const Pixel& pixel, std::int32_t x, std::int32_t y) const
{
    if (x < 0 || y < 0 || x >= static_cast<std::int32_t>(width_) || y >= static_cast<std::int32_t>(height_))
        return nullptr;
    const Pixel& other = pixels_[static_cast<std::uint32_t>(y) * kSide + static_cast<std::uint32_t>(x)];
    if (!other.asks || glm::dot(pixel.surface.normal, other.surface.normal) < kAlikeCosine) return nullptr;
    const glm::vec3 apart = other.centre.origin - pixel.centre.origin;
    const float off = std::fmin(std::fabs(glm::dot(pixel.surface.normal, apart)),
                                std::fabs(glm::dot(other.surface.normal, apart)));
    return off <= kAlikeFootprints * light_.pixelSize * pixel.surface.w ? &other : nullptr;
}

/// On the way forward: what is seen from the left, or from above, is believed to be seen from here.
void CoherenceTile::predict(std::uint32_t x, std::uint32_t y)
{
    Pixel& pixel = at(x, y);
    if (!pixel.asks) return;
    const auto column = static_cast<std::int32_t>(x), row = static_cast<std::int32_t>(y);
    const Pixel* left = alike(pixel, column - 1, row);
    const Pixel* above = alike(pixel, column, row - 1);
    const Pixel* before = left ? left : above;
    CellMask doubted = light_.grid.all();
    if (before) {
        doubted = left && above ? left->seen ^ above->seen : 0;
        pixel.seen |= before->seen & ~pixel.known;
    }
    followBorder(light_.grid, pixel.seen, pixel.known, doubted, [&](CellMask cells) { return ask(pixel, cells); });
}

/// On the way back: what any neighbour has found out otherwise is asked again.
void CoherenceTile::review(std::uint32_t x, std::uint32_t y)
{
    Pixel& pixel = at(x, y);
    if (!pixel.asks) return;
    const auto column = static_cast<std::int32_t>(x), row = static_cast<std::int32_t>(y);
    CellMask doubted = 0;
    for (const Pixel* other : {alike(pixel, column + 1, row), alike(pixel, column, row + 1),
                               alike(pixel, column - 1, row), alike(pixel, column, row - 1)})
        if (other) doubted |= pixel.seen ^ other->seen;
    followBorder(light_.grid, pixel.seen, pixel.known, doubted, [&](CellMask cells) { return ask(pixel, cells); });
}

void CoherenceTile::answer(const Receivers& receivers, std::uint32_t left, std::uint32_t top, std::uint32_t width,
                           std::uint32_t height, std::span<std::uint8_t> visibility, std::size_t stride)
{
    width_ = width;
    height_ = height;
    rays_ = 0;
    read(receivers, left, top, visibility, stride);
    askRims(left, top);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            predict(x, y);
    for (std::uint32_t y = height; y-- > 0;)
        for (std::uint32_t x = width; x-- > 0;)
            review(x, y);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            if (const Pixel& pixel = at(x, y); pixel.asks)
                visibility[y * stride + x] =
                    static_cast<std::uint8_t>(std::lround(255.0f * light_.grid.share(pixel.seen)));
    host_.countRays(rays_);
}

} // namespace gnomon
