#pragma once
// A light's source as a quadtree of squares with a point at each corner: which points are needed, and what each of them
// counts. Plain CPU code.
#include <array>
#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

namespace gnomon {

/// A lattice of 17 x 17 points: four levels of squares below the whole source (Macedo 2018, 6.1).
constexpr std::uint32_t kQuadLevels = 4;
constexpr std::uint32_t kLattice = (1u << kQuadLevels) + 1;
constexpr std::uint32_t kLatticePoints = kLattice * kLattice;
/// Words of 32 points, those of a level in words of their own: 4, 5, 16, 56 and 208 points.
constexpr std::uint32_t kPointWords = 12;
constexpr std::uint32_t kWordPoints = 32;
constexpr std::array<std::uint32_t, kQuadLevels + 2> kFirstWord = {0, 1, 2, 3, 5, kPointWords};
constexpr std::uint32_t kMostQuads = 1u << (2 * (kQuadLevels - 1)); ///< That may be divided, of a level.

/// A point of the lattice.
struct LatticePoint {
    std::uint32_t x = 0, y = 0; ///< Below kLattice.

    /// In the square [-1, 1]^2.
    glm::vec2 square() const { return glm::vec2(x, y) * (2.0f / (kLattice - 1)) - 1.0f; }
};

/// The point in a place of the words; none: x is kLattice.
LatticePoint pointIn(std::uint32_t place);
/// And where a point is: 32 times the word, and its bit.
std::uint32_t placeOf(LatticePoint point);

/// A square of a level, by its corner of least x and y.
struct SourceQuad {
    LatticePoint corner;

    LatticePoint at(std::uint32_t i, std::uint32_t level) const ///< Corner i: 1 adds to x, 2 to y.
    {
        const std::uint32_t step = (kLattice - 1) >> level;
        return {corner.x + (i & 1) * step, corner.y + (i >> 1) * step};
    }
};

/// The tree as far as it is known.
class SourceQuads {
public:
    SourceQuads();

    std::uint32_t level() const { return level_; }
    /// Squares of the newest level.
    std::span<const SourceQuad> quads() const { return {quads_.data(), count_}; }
    /// Bits of the points needed, of all levels until now.
    std::uint32_t needed(std::uint32_t word) const { return needed_[word]; }
    std::uint32_t points() const; ///< Needed.

    /// Those squares of the newest level that are flagged become four of the next, the others stay as they are.
    void divide(std::span<const std::uint32_t> flags);
    /// No square is divided any more. Weights: a square's area in equal parts to its corners, one in all.
    void end();
    float weight(std::uint32_t place) const { return weights_[place]; }

private:
    void need(SourceQuad quad);
    void keep(SourceQuad quad);

    std::uint32_t level_ = 0, count_ = 1;
    std::array<SourceQuad, 4 * kMostQuads> quads_{};
    std::array<std::uint32_t, kPointWords> needed_{};
    std::array<float, kPointWords * kWordPoints> weights_{};
};

} // namespace gnomon
