#include "algorithms/shared/box_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

namespace gnomon {

namespace {

/// Part of its largest coordinate by which a corner may be off: a device turns an object by three products and sums and
/// takes the zero away, the bounds were rounded likewise, 2^-23 to 2^-22 each.
constexpr float kWorldRounding = 0x1p-20f;

/// Half widths of the map by which anything that is drawn may lie off: vertices are snapped to 1/16 of a texel or finer
/// (Vulkan 1.3, subPixelPrecisionBits), which is 1/1024 with 64 texels; w is known to 2^-22 of the greatest, so to
/// 2^-12 of any, which moves a corner at most kFar out by 1/512.
constexpr float kMargin = 1.0f / 128.0f;

/// Half widths. Farther out, w is small beside what it is the difference of.
constexpr float kFar = 8.0f;

/// Greatest w over least: a box that is so much deeper than its near end is far from the light is a needle, and
/// rounding of its far end is felt at the near one.
constexpr float kDeep = 1024.0f;

/// Cells of a row, or rows, between two places in half widths from the middle.
std::uint32_t cellRange(float from, float to)
{
    const float first = std::floor((from + 1.0f) * 4.0f), last = std::floor((to + 1.0f) * 4.0f);
    if (!(first <= 7.0f && last >= 0.0f)) return 0;
    const auto begin = static_cast<std::uint32_t>(std::max(first, 0.0f));
    const auto end = static_cast<std::uint32_t>(std::min(last, 7.0f)) + 1;
    return (1u << end) - (1u << begin);
}

} // namespace

Cells boxCells(const Aabb& boxWs, const glm::mat4& clipFromZero, const glm::vec3& zeroWs)
{
    const glm::vec3 largest = glm::max(glm::abs(boxWs.lower), glm::abs(boxWs.upper));
    const float rounding = kWorldRounding * std::max({largest.x, largest.y, largest.z});
    const glm::vec3 low = boxWs.lower - rounding - zeroWs, high = boxWs.upper + rounding - zeroWs;
    glm::vec2 first(kFar), last(-kFar);
    float least = std::numeric_limits<float>::infinity(), greatest = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
        const glm::vec4 clip = clipFromZero * glm::vec4(p, 1.0f);
        if (!(clip.w * kFar > std::max(std::abs(clip.x), std::abs(clip.y)))) return kAllCells;
        least = std::min(least, clip.w);
        greatest = std::max(greatest, clip.w);
        const glm::vec2 at = glm::vec2(clip) / clip.w;
        first = glm::min(first, at);
        last = glm::max(last, at);
    }
    if (greatest > kDeep * least) return kAllCells;
    const std::uint32_t columns = cellRange(first.x - kMargin, last.x + kMargin);
    const std::uint32_t rows = cellRange(first.y - kMargin, last.y + kMargin);
    Cells cells = 0;
    for (std::uint32_t y = 0; y < 8; ++y)
        if (rows >> y & 1) cells |= Cells{columns} << (8 * y);
    return cells;
}

} // namespace gnomon
