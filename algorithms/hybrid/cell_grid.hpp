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

    /// Some cells of the rim, spread around it. The sets of `rimSets()` consecutive numbers hold all of it.
    CellMask rim(std::uint32_t number) const { return rim_[number % rimSets()]; }
    std::uint32_t rimSets() const { return side_ - 1; }

    /// Where a cell is asked, in the unit disc. Equal areas for all cells; neighbours in the grid are neighbours there,
    /// the rim of the grid is the rim of the disc.
    glm::vec2 at(std::uint32_t bit) const { return at_[bit]; }

    float share(CellMask seen) const
    {
        return static_cast<float>(std::popcount(seen)) / static_cast<float>(count());
    }

private:
    static constexpr CellMask kFirstColumn = 0x0101010101010101ull, kLastColumn = kFirstColumn << 7;

    std::uint32_t side_;
    CellMask all_ = 0;
    std::array<CellMask, kMaxSide - 1> rim_{};
    std::array<glm::vec2, kMaxSide * kMaxSide> at_{};
};

/// From the square [-1, 1]^2 to the unit disc, equal areas to equal areas and squares about the centre to circles.
/// Source: P. Shirley and K. Chiu, "A low distortion map between disk and square", Journal of Graphics Tools 2(3), 1997.
glm::vec2 discOfSquare(glm::vec2 square);

/// Finds the cells that a receiver sees, from what is believed of it: asks the cells on the border of what is seen, and
/// again wherever an answer has moved that border, until all of it has been asked.
/// @param seen in: what is believed, right in `known`; out: what was found.
/// @param known in: cells that were asked; out: all that were.
/// @param doubted cells to ask in any case.
/// @param ask ask(cells): those of the cells that are seen.
template <typename Ask>
void followBorder(const CellGrid& grid, CellMask& seen, CellMask& known, CellMask doubted, Ask&& ask)
{
    for (;;) {
        const CellMask cells = (grid.border(seen) | doubted) & ~known;
        if (cells == 0) return;
        seen = (seen & ~cells) | (ask(cells) & cells);
        known |= cells;
    }
}

} // namespace gnomon
