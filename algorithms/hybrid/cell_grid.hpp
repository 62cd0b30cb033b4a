#pragma once
// A light's surface in square cells, a bit each: which cells a receiver sees. Pure arithmetic on 64-bit masks.
#include <array>
#include <bit>
#include <cstdint>

#include <glm/vec2.hpp>

namespace gnomon {

/// Bit 8 row + column: 1 where the cell is seen.
using CellMask = std::uint64_t;

class CellGrid {
public:
    static constexpr std::uint32_t kMaxSide = 8;

    /// @param side cells a row, 2 to 8.
    explicit CellGrid(std::uint32_t side);

    std::uint32_t side() const { return side_; }
    std::uint32_t count() const { return side_ * side_; }
    CellMask all() const { return all_; }

    /// The cells and their eight neighbours.
    CellMask grown(CellMask cells) const
    {
        const CellMask wide = cells | (cells << 1 & ~kFirstColumn) | (cells >> 1 & ~kLastColumn);
        return (wide | wide << kMaxSide | wide >> kMaxSide) & all_;
    }
    /// Cells with a neighbour, of eight, that is not like them.
    CellMask border(CellMask seen) const { return (grown(seen) & ~seen) | (grown(all_ & ~seen) & seen); }

    /// Two opposite cells of the rim. The sets of `rimSets()` consecutive numbers hold all of it.
    CellMask rim(std::uint32_t number) const { return rim_[number % rimSets()]; }
    std::uint32_t rimSets() const { return 2 * (side_ - 1); }

    /// Where a cell is asked, in the unit disc. Equal areas for all cells; neighbours in the grid are neighbours there,
    /// the rim of the grid is the rim of the disc.
    glm::vec2 at(std::uint32_t bit) const { return at_[bit]; }

    float share(CellMask seen) const { return static_cast<float>(std::popcount(seen)) / static_cast<float>(count()); }

private:
    static constexpr CellMask kFirstColumn = 0x0101010101010101ull, kLastColumn = kFirstColumn << 7;

    std::uint32_t side_;
    CellMask all_ = 0;
    std::array<CellMask, 2 * (kMaxSide - 1)> rim_{};
    std::array<glm::vec2, kMaxSide * kMaxSide> at_{};
};

/// What is known of the cells that a receiver sees. Once next() names none, all cells on the border of what is seen
/// have been asked: it has been followed wherever answers have moved it.
struct CellPicture {
    CellMask seen = 0;  ///< As believed, or found.
    CellMask known = 0; ///< Cells that have been asked.

    /// The cells to ask next. @param doubted to be asked in any case.
    CellMask next(const CellGrid& grid, CellMask doubted) const { return (grid.border(seen) | doubted) & ~known; }
    /// @param answer those of the cells that are seen.
    void learn(CellMask cells, CellMask answer)
    {
        seen = (seen & ~cells) | (answer & cells);
        known |= cells;
    }
};

} // namespace gnomon
