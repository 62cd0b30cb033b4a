#include "algorithms/common/map_cells.hpp"

#include <bit>
#include <utility>

namespace gnomon {

Cells changedCells(const KeptParts& from, const KeptParts& to)
{
    return to.ground != 0 && from.ground == to.ground ? from.covered | to.covered : kAllCells;
}

std::span<const VkRect2D> cellRegions(Cells cells, std::uint32_t resolution, std::span<VkRect2D, 32> regions)
{
    constexpr std::uint32_t kSide = 8;
    const auto row = [&](std::uint32_t y) { return static_cast<std::uint32_t>(cells >> (kSide * y) & 0xff); };
    const auto texels = [&](std::uint32_t first, std::uint32_t end) { // where a side is no multiple of 8, outwards
        const std::uint32_t from = first * resolution / kSide;
        return std::pair{from, (end * resolution + kSide - 1) / kSide - from};
    };
    std::size_t count = 0;
    for (std::uint32_t y = 0, next = 0; y < kSide; y = next) {
        for (next = y + 1; next < kSide && row(next) == row(y);)
            ++next;
        for (std::uint32_t bits = row(y); bits != 0;) {
            const auto first = static_cast<std::uint32_t>(std::countr_zero(bits));
            const auto length = static_cast<std::uint32_t>(std::countr_one(bits >> first));
            const auto [x0, width] = texels(first, first + length);
            const auto [y0, height] = texels(y, next);
            regions[count++] = {{static_cast<std::int32_t>(x0), static_cast<std::int32_t>(y0)}, {width, height}};
            bits &= bits + (1u << first); // clears the lowest run
        }
    }
    return regions.first(count);
}

} // namespace gnomon
