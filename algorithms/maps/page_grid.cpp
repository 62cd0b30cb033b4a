#include "algorithms/maps/page_grid.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

namespace gnomon {

namespace {

// Bits of a key: 7 of the level, 3 of the face, 27 of the row, 27 of the column.
constexpr std::uint64_t kPlaceBits = 27, kPlaceMask = (1u << kPlaceBits) - 1, kFaceBits = 3;
constexpr int kZeroPlace = 1 << (kPlaceBits - 1), kZeroLevel = 64;

/// Of a map about a place what receivers lie in: less than 1/64 of the finest texel is left out on each side.
constexpr double kShort = 1.0 - 0x1p-20;

int placeIn(double pages)
{
    // Also of what is no number.
    return static_cast<int>(std::max(1.0 - kZeroPlace, std::min(kZeroPlace - 2.0, std::floor(pages))));
}

} // namespace

PageKey keyOf(const Page& page)
{
    const auto level = static_cast<std::uint64_t>(page.level + kZeroLevel);
    const auto row = static_cast<std::uint64_t>(page.y + kZeroPlace),
               column = static_cast<std::uint64_t>(page.x + kZeroPlace);
    return (level << kFaceBits | page.face) << (2 * kPlaceBits) | row << kPlaceBits | column;
}

Page pageOf(PageKey key)
{
    const PageKey levelAndFace = key >> (2 * kPlaceBits);
    return {static_cast<int>(levelAndFace >> kFaceBits) - kZeroLevel, static_cast<int>(key & kPlaceMask) - kZeroPlace,
            static_cast<int>(key >> kPlaceBits & kPlaceMask) - kZeroPlace,
            static_cast<std::uint32_t>(levelAndFace & ((1u << kFaceBits) - 1))};
}

PageGrid::PageGrid(const LightFit& whole, const LightView& light, const double (&origin)[3], std::uint32_t texels,
                   std::uint32_t border, std::uint32_t face)
    : whole_(whole), positional_(light.type != GN_LIGHT_TYPE_DIRECTIONAL), texels_(texels), border_(border), face_(face)
{
    const glm::dmat4 rows = glm::transpose(glm::dmat4(whole.clipFromWorld));
    const glm::dvec3 zero = positional_ ? glm::dvec3(light.position()) : glm::dvec3(0.0);
    const auto about = [&](glm::dvec3 normal) { return glm::dvec4(normal, -glm::dot(normal, zero)); };
    for (int axis = 0; axis < 2; ++axis) {
        const double half = half_[axis] = 1.0 / glm::length(glm::dvec3(rows[axis]));
        const glm::dvec3 side = half * glm::dvec3(rows[axis]);
        sides_[axis] = about(side);
        const double middle = positional_ ? 0.0 : -rows[axis].w * half;
        // The receivers of a cube's face lie within 45 degrees, whatever the fit has around them.
        const double reach = light.type == GN_LIGHT_TYPE_POINT ? 1.0 : half,
                     reached = positional_ ? reach * kShort : reach;
        all_.low[axis] = middle - reached;
        all_.high[axis] = middle + reached;
        // Counted from a corner, one page holds a map that is as wide; from its middle on that takes four.
        zero_[axis] = positional_ ? reach : glm::dot(side, glm::dvec3(origin[0], origin[1], origin[2]));
    }
    if (!positional_) return;
    depth_ = about(glm::normalize(glm::dvec3(rows[3])));
    nearest_ = static_cast<double>(whole.nearWs);
}

// Texels of suns no narrower than 1 mm: places are floats, 256 m from the frame's origin they are known to 1/64 mm. Of
// others no finer than of a map of 16 384 about a cone of 90 degrees.
int PageGrid::finestLevel() const
{
    return positional_ ? -13 : -10;
}

double PageGrid::width(int level) const
{
    return std::ldexp(static_cast<double>(texels_), level);
}

glm::dvec2 PageGrid::placeOf(glm::dvec3 point) const
{
    const glm::dvec4 p(point, 1.0);
    return glm::dvec2(glm::dot(sides_[0], p), glm::dot(sides_[1], p)) / glm::dot(depth_, p);
}

std::array<glm::dvec4, 4> PageGrid::edges() const
{
    return {sides_[0] - all_.low.x * depth_, all_.high.x * depth_ - sides_[0], sides_[1] - all_.low.y * depth_,
            all_.high.y * depth_ - sides_[1]};
}

PlaneRect PageGrid::rectOf(const Aabb& box) const
{
    PlaneRect rect{glm::dvec2(INFINITY), glm::dvec2(-INFINITY)};
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                           corner & 4 ? box.upper.z : box.lower.z);
        if (!(glm::dot(depth_, glm::dvec4(p, 1.0)) > 1e-6)) return all_;
        const glm::dvec2 place = placeOf(p);
        rect = {glm::min(rect.low, place), glm::max(rect.high, place)};
    }
    return rect;
}

PlaneRect PageGrid::rectOf(const Page& page) const
{
    const double texel = std::ldexp(1.0, page.level), around = border_ * texel;
    const glm::dvec2 corner = cornerOf(page);
    return {corner - around, corner + texels_ * texel + around};
}

PageRect PageGrid::pagesIn(const PlaneRect& rect, int level) const
{
    const double side = width(level);
    const glm::dvec2 low = (rect.low + zero_) / side, high = (rect.high + zero_) / side;
    return {{placeIn(low.x), placeIn(low.y)}, {placeIn(high.x), placeIn(high.y)}};
}

glm::dvec2 PageGrid::cornerOf(const Page& page) const
{
    return width(page.level) * glm::dvec2(page.x, page.y) - zero_;
}

LightFit PageGrid::window(const PlaneRect& rect) const
{
    const glm::dvec2 middle = 0.5 * (rect.low + rect.high), half = 0.5 * (rect.high - rect.low);
    if (!positional_) return fitWindow(whole_, middle, half);
    const glm::dvec2 scale = half_ / half, moved = -middle / half;
    return fitProjected(whole_, {scale.x, 0.0, 0.0, 0.0, scale.y, 0.0, moved.x, moved.y, 1.0}, 1.0);
}

LightFit PageGrid::fitOf(const Page& page) const
{
    return window(rectOf(page));
}

LightFit PageGrid::fitAt(const Page& page, std::uint32_t side) const
{
    const glm::dvec2 corner = cornerOf(page);
    return window({corner, corner + std::ldexp(static_cast<double>(side), page.level)});
}

} // namespace gnomon
