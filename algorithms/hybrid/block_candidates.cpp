#include "algorithms/hybrid/block_candidates.hpp"

#include <bit>
#include <cmath>

#include "algorithms/shared/receivers.hpp"

namespace gnomon {

namespace {

void put(const glm::dvec3& from, float (&to)[3])
{
    for (int i = 0; i < 3; ++i)
        to[i] = static_cast<float>(from[i]);
}

} // namespace

simd::CandidateTriangle rounded(const CandidateOccluder& candidate)
{
    simd::CandidateTriangle triangle;
    const glm::dvec3 corners[] = {candidate.a, candidate.b, candidate.c};
    for (int i = 0; i < 3; ++i) {
        put(corners[i], triangle.corner[i]);
        put(corners[(i + 1) % 3] - corners[i], triangle.edge[i]);
        triangle.length[i] = static_cast<float>(candidate.lengths[i]);
    }
    put(candidate.normal, triangle.normal);
    triangle.size = static_cast<float>(candidate.size);
    triangle.stretch = static_cast<float>(candidate.stretch);
    return triangle;
}

OwnTexels ownTexels(const HostMap& map, const simd::MapPlaces& places, std::uint32_t lanes)
{
    OwnTexels texels{};
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(lanes));
        const auto column = static_cast<std::int32_t>(std::floor(places.x[i]));
        const auto row = static_cast<std::int32_t>(std::floor(places.y[i]));
        const std::span<const std::uint32_t> layer = map.triangle[places.layer[i]];
        const auto side = static_cast<std::int32_t>(map.side);
        if (layer.empty() || column < 0 || row < 0 || column >= side || row >= side) continue;
        texels.triangle[i] = &layer[static_cast<std::size_t>(row) * map.side + static_cast<std::size_t>(column)];
        prefetchRead(texels.triangle[i]);
    }
    return texels;
}

BlockCandidates::BlockCandidates(const NumberedTriangles& triangles) : triangles_(triangles) {}

const BlockCandidates::Kept& BlockCandidates::keep(std::uint32_t number)
{
    Kept& kept = kept_[number % kPlaces];
    if (kept.number == number) return kept;
    const std::optional<CandidateOccluder> candidate = triangles_.candidate(number);
    kept.number = number;
    kept.testifies = candidate.has_value();
    if (candidate) kept.triangle = rounded(*candidate);
    return kept;
}

NamedTriangles BlockCandidates::named(const OwnTexels& texels) const
{
    NamedTriangles named;
    for (std::uint32_t i = 0; i < simd::kLanes; ++i) {
        const std::uint32_t* texel = texels.triangle[i];
        if (!texel || *texel == kNoTriangle) continue;
        std::uint32_t place = 0;
        while (place < named.count && named.number[place] != *texel)
            ++place;
        if (place == named.count) {
            named.number[named.count] = *texel;
            named.lanes[named.count++] = 0;
            if (!keeps(*texel)) prefetchRead(triangles_.corners(*texel));
        }
        named.lanes[place] |= 1u << i;
    }
    return named;
}

void BlockCandidates::call(const NamedTriangles& named) const
{
    for (std::uint32_t i = 0; i < named.count; ++i) {
        if (keeps(named.number[i])) continue;
        const std::uint32_t* corners = triangles_.corners(named.number[i]);
        const glm::vec3* positions = triangles_.of(named.number[i]).caster->mesh->positions.data();
        for (int k = 0; k < 3; ++k)
            prefetchRead(positions + corners[k]);
    }
}

std::uint32_t BlockCandidates::dark(const BlockReader& reader, const simd::Block& block, const NamedTriangles& named)
{
    std::uint32_t dark = 0;
    for (std::uint32_t i = 0; i < named.count; ++i) {
        if ((named.lanes[i] & ~dark) == 0) continue;
        if (const Kept& kept = keep(named.number[i]); kept.testifies) dark |= reader.blocked(block, kept.triangle);
    }
    return dark;
}

} // namespace gnomon
