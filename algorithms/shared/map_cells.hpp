#pragma once
// Parts of a map's layer, for what is brought up to date in parts.
#include <cstdint>
#include <span>

#include "runtime/passes/pass_builder.hpp"

namespace gnomon {

/// Cells of a grid of 8 x 8 over a layer, row by row, bit 0 the one with texel (0, 0).
using Cells = std::uint64_t;
constexpr Cells kAllCells = ~Cells{0};

/// What differs between two states of a layer, at most.
Cells changedCells(const KeptParts& from, const KeptParts& to);

/// The cells and the eight about each: what is drawn a cell's side farther out at most.
Cells withNeighbours(Cells cells);

/// Rectangles of texels that hold the cells, four or fewer for a row and one for rows that are alike.
/// @return of `regions`, those that are used.
std::span<const VkRect2D> cellRegions(Cells cells, std::uint32_t resolution, std::span<VkRect2D, 32> regions);
/// The smallest one that holds them all; of no cells it is empty.
VkRect2D cellBounds(Cells cells, std::uint32_t resolution);

/// Cells of one square image into the same place of another one of its size and format.
struct CellCopy {
    const char* name = ""; ///< Of the pass, with the variant.
    Scope scope = Scope::light;
    std::uint32_t variant = 0;
    ImageId from, to;
    std::uint32_t fromLayer = 0, toLayer = 0;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
    std::uint32_t side = 0; ///< Of both, texels.
    Cells cells = kAllCells;
};
/// Once however many tasks declare it.
void declareCellCopy(PassBuilder& passes, const CellCopy& copy);

} // namespace gnomon
