#include "algorithms/shared/map_cells.hpp"

#include <array>
#include <bit>
#include <utility>

#include "runtime/passes/pass_context.hpp"

namespace gnomon {

namespace {

constexpr std::uint32_t kSide = 8;

std::uint32_t row(Cells cells, std::uint32_t y)
{
    return static_cast<std::uint32_t>(cells >> (kSide * y) & 0xff);
}

/// Of columns or rows of cells: the first texel and how many, outwards where a side is no multiple of 8.
std::pair<std::uint32_t, std::uint32_t> texels(std::uint32_t first, std::uint32_t end, std::uint32_t resolution)
{
    const std::uint32_t from = first * resolution / kSide;
    return {from, (end * resolution + kSide - 1) / kSide - from};
}

/// Cells [x0, x1) of rows [y0, y1).
VkRect2D texelsOf(std::uint32_t x0, std::uint32_t x1, std::uint32_t y0, std::uint32_t y1, std::uint32_t resolution)
{
    const auto [x, width] = texels(x0, x1, resolution);
    const auto [y, height] = texels(y0, y1, resolution);
    return {{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}, {width, height}};
}

} // namespace

Cells changedCells(const KeptParts& from, const KeptParts& to)
{
    return to.base != 0 && from.base == to.base ? from.covered | to.covered : kAllCells;
}

Cells withNeighbours(Cells cells)
{
    constexpr Cells kFirstColumn = 0x0101010101010101u;
    cells |= (cells << 1 & ~kFirstColumn) | (cells >> 1 & ~(kFirstColumn << 7));
    return cells | cells << 8 | cells >> 8;
}

std::span<const VkRect2D> cellRegions(Cells cells, std::uint32_t resolution, std::span<VkRect2D, 32> regions)
{
    std::size_t count = 0;
    for (std::uint32_t y = 0, next = 0; y < kSide; y = next) {
        for (next = y + 1; next < kSide && row(cells, next) == row(cells, y);)
            ++next;
        for (std::uint32_t bits = row(cells, y); bits != 0;) {
            const auto first = static_cast<std::uint32_t>(std::countr_zero(bits));
            const auto length = static_cast<std::uint32_t>(std::countr_one(bits >> first));
            regions[count++] = texelsOf(first, first + length, y, next, resolution);
            bits &= bits + (1u << first); // clears the lowest run
        }
    }
    return regions.first(count);
}

VkRect2D cellBounds(Cells cells, std::uint32_t resolution)
{
    if (cells == 0) return {};
    std::uint32_t columns = 0;
    for (std::uint32_t y = 0; y < kSide; ++y)
        columns |= row(cells, y);
    const auto firstRow = static_cast<std::uint32_t>(std::countr_zero(cells)) / kSide;
    const auto rowsEnd = kSide - static_cast<std::uint32_t>(std::countl_zero(cells)) / kSide;
    return texelsOf(static_cast<std::uint32_t>(std::countr_zero(columns)),
                    static_cast<std::uint32_t>(std::bit_width(columns)), firstRow, rowsEnd, resolution);
}

void declareCellCopy(PassBuilder& passes, const CellCopy& copy)
{
    passes.transfer(copy.name, copy.scope, copy.variant)
        .copies(copy.from, {.layer = copy.fromLayer})
        .writes(copy.to, {.layer = copy.toLayer})
        .record([copy](PassContext& gpu) {
            std::array<VkRect2D, 32> room;
            std::array<VkImageCopy2, 32> regions;
            std::uint32_t count = 0;
            for (const VkRect2D& rect : cellRegions(copy.cells, copy.side, room)) {
                const VkOffset3D at{rect.offset.x, rect.offset.y, 0};
                regions[count++] = {.sType = VK_STRUCTURE_TYPE_IMAGE_COPY_2,
                                    .srcSubresource = {copy.aspect, 0, copy.fromLayer, 1},
                                    .srcOffset = at,
                                    .dstSubresource = {copy.aspect, 0, copy.toLayer, 1},
                                    .dstOffset = at,
                                    .extent = {rect.extent.width, rect.extent.height, 1}};
            }
            const VkCopyImageInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_INFO_2,
                                        .srcImage = gpu.image(copy.from),
                                        .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        .dstImage = gpu.image(copy.to),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = count,
                                        .pRegions = regions.data()};
            gpu.vk->vkCmdCopyImage2(gpu.cmd, &info);
        });
}

} // namespace gnomon
