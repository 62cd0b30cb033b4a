#pragma once
// Triangles that a map names, asked against the rays of sixteen pixels at once.
#include <cstdint>

#include "algorithms/hybrid/candidate_occluder.hpp"
#include "algorithms/hybrid/host_map.hpp"
#include "algorithms/hybrid/map_texels.hpp"
#include "algorithms/hybrid/tile_blocks.hpp"

namespace gnomon {

/// As simd::Kernels::blocked() takes it.
simd::CandidateTriangle rounded(const CandidateOccluder& candidate);

/// The texels in which receivers of a block lie; null beyond the map, and of lanes that are not wanted.
struct OwnTexels {
    const std::uint32_t* triangle[simd::kLanes];
};
/// Calls for them. @param lanes bits of those that are wanted
OwnTexels ownTexels(const HostMap& map, const simd::MapPlaces& places, std::uint32_t lanes);

/// The triangles that texels of a block name.
struct NamedTriangles {
    std::uint32_t count = 0;
    std::uint32_t number[simd::kLanes];
    std::uint32_t lanes[simd::kLanes]; ///< Bits of those that name it.
};

/// Triangles by number, remembered for the next block: neighbouring ones name the same. Of one thread.
/// Those of a mesh lie all over its arrays: what dark() reads is called for in steps, for some blocks at a time.
class BlockCandidates {
public:
    explicit BlockCandidates(const NumberedTriangles& triangles);

    /// Which triangles the texels name; calls for the indices of those that are not remembered.
    NamedTriangles named(const OwnTexels& texels) const;
    /// Calls for their corners.
    void call(const NamedTriangles& named) const;
    /// Asks all of the block about them. @param reader of the block
    /// @return bits of the lanes that ask a ray and are surely dark: the tracer says so, too
    std::uint32_t dark(const BlockReader& reader, const simd::Block& block, const NamedTriangles& named);

private:
    struct Kept {
        std::uint32_t number = kNoTriangle;
        bool testifies = false;
        simd::CandidateTriangle triangle{};
    };
    // What 64 columns of some rows meet. 35 kB.
    static constexpr std::uint32_t kPlaces = 256;

    bool keeps(std::uint32_t number) const { return kept_[number % kPlaces].number == number; }
    const Kept& keep(std::uint32_t number);

    const NumberedTriangles& triangles_;
    Kept kept_[kPlaces];
};

} // namespace gnomon
