#include "algorithms/area/source_quads.hpp"

#include <bit>

namespace gnomon {

namespace {

/// The level that a point comes with.
constexpr std::uint32_t levelOf(std::uint32_t x, std::uint32_t y)
{
    for (std::uint32_t level = 0; level < kQuadLevels; ++level)
        if ((x | y) % ((kLattice - 1) >> level) == 0) return level;
    return kQuadLevels;
}

struct Places {
    std::array<std::uint16_t, kLatticePoints> of{};
    std::array<std::uint16_t, kPointWords * kWordPoints> point{};
};

constexpr Places makePlaces()
{
    Places places;
    for (std::uint16_t& point : places.point)
        point = kLatticePoints;
    std::array<std::uint32_t, kQuadLevels + 1> next{};
    for (std::uint32_t level = 0; level <= kQuadLevels; ++level)
        next[level] = kWordPoints * kFirstWord[level];
    for (std::uint32_t point = 0; point < kLatticePoints; ++point) {
        const std::uint32_t place = next[levelOf(point % kLattice, point / kLattice)]++;
        places.of[point] = static_cast<std::uint16_t>(place);
        places.point[place] = static_cast<std::uint16_t>(point);
    }
    return places;
}

constexpr Places kPlaces = makePlaces();

} // namespace

LatticePoint pointIn(std::uint32_t place)
{
    const std::uint32_t point = kPlaces.point[place];
    return point < kLatticePoints ? LatticePoint{point % kLattice, point / kLattice} : LatticePoint{kLattice, 0};
}

std::uint32_t placeOf(LatticePoint point)
{
    return kPlaces.of[point.y * kLattice + point.x];
}

SourceQuads::SourceQuads()
{
    need(quads_[0]);
}

std::uint32_t SourceQuads::points() const
{
    std::uint32_t count = 0;
    for (const std::uint32_t word : needed_)
        count += static_cast<std::uint32_t>(std::popcount(word));
    return count;
}

void SourceQuads::need(SourceQuad quad)
{
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t place = placeOf(quad.at(i, level_));
        needed_[place / kWordPoints] |= 1u << place % kWordPoints;
    }
}

void SourceQuads::keep(SourceQuad quad)
{
    const float area = 1.0f / static_cast<float>(1u << (2 * level_));
    for (std::uint32_t i = 0; i < 4; ++i)
        weights_[placeOf(quad.at(i, level_))] += 0.25f * area;
}

void SourceQuads::divide(std::span<const std::uint32_t> flags)
{
    std::array<SourceQuad, kMostQuads> divided;
    std::uint32_t dividing = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
        if (level_ < kQuadLevels && flags[i] != 0)
            divided[dividing++] = quads_[i];
        else
            keep(quads_[i]);
    }
    ++level_;
    count_ = 0;
    for (std::uint32_t i = 0; i < dividing; ++i) {
        for (std::uint32_t part = 0; part < 4; ++part) {
            quads_[count_] = {divided[i].at(part, level_)};
            need(quads_[count_++]);
        }
    }
}

void SourceQuads::end()
{
    for (const SourceQuad& quad : quads())
        keep(quad);
    count_ = 0;
}

} // namespace gnomon
