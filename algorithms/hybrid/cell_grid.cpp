#include "algorithms/hybrid/cell_grid.hpp"

#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

/// The rim's cells in the order in which they go round, as bits.
std::uint32_t onRim(std::uint32_t step, std::uint32_t side)
{
    const std::uint32_t last = side - 1, along = step % last;
    switch (step / last) {
    case 0:
        return along;
    case 1:
        return CellGrid::kMaxSide * along + last;
    case 2:
        return CellGrid::kMaxSide * last + last - along;
    default:
        return CellGrid::kMaxSide * (last - along);
    }
}

} // namespace

glm::vec2 discOfSquare(glm::vec2 square)
{
    if (square.x == 0.0f && square.y == 0.0f) return square;
    constexpr float eighth = std::numbers::pi_v<float> / 4.0f; // of a turn: from a side's middle to its corner
    const bool wide = std::fabs(square.x) > std::fabs(square.y);
    const float radius = wide ? square.x : square.y;
    const float angle = wide ? eighth * square.y / square.x : eighth * (2.0f - square.x / square.y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

CellGrid::CellGrid(std::uint32_t side) : side_(side)
{
    const float cell = 2.0f / static_cast<float>(side);
    for (std::uint32_t row = 0; row < side; ++row) {
        for (std::uint32_t column = 0; column < side; ++column) {
            const std::uint32_t bit = kMaxSide * row + column;
            all_ |= CellMask{1} << bit;
            // Within its cell a sample is moved by the number of the row and of the column, so that no two share a
            // column or a row of side^2: an edge along the grid uncovers one after the other, not eight at once.
            // Source: A. Kensler, "Correlated multi-jittered sampling", Pixar Technical Memo 13-01, 2013, the canonical
            // arrangement. Not jittered from pixel to pixel: neighbours would disagree about cells that no edge crosses.
            const glm::vec2 within = (glm::vec2(row, column) + 0.5f) / static_cast<float>(side);
            at_[bit] = discOfSquare(cell * (glm::vec2(column, row) + within) - 1.0f);
        }
    }
    for (std::uint32_t step = 0; step < 4 * (side - 1); ++step)
        rim_[step % (side - 1)] |= CellMask{1} << onRim(step, side);
}

} // namespace gnomon
