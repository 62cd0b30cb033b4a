#pragma once
// The pixels that a chain asks without the thesis's candidate occluders, sixteen at a time: hints where nobody gave
// them before, triangles that own texels name, rays.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include "algorithms/hybrid/bit_rows.hpp"
#include "algorithms/hybrid/chain_pass.hpp"
#include "algorithms/hybrid/tile_blocks.hpp"
#include "algorithms/shared/receivers.hpp"

namespace gnomon {

/// What all threads of the pass share.
struct ChainPicture {
    const ChainJob& job;
    const HostContext& host;
    const Receivers& receivers;
    const BlockReader& blocks;
    const HostMap& map;
    BitRows lit;                            ///< By the map.
    std::span<const std::uint64_t> settled; ///< Rows of bits, or none.
};

/// Some rows of it.
struct ChainRows {
    std::uint32_t top, bottom; ///< `top`: a multiple of a block's side.
    BitRows asked;             ///< Row 0 is `top`.
    std::span<std::uint8_t> bytes;

    std::uint8_t& at(std::uint32_t x, std::uint32_t y) const { return bytes[std::size_t(y - top) * asked.width + x]; }
};

/// Shows what a pixel is. @param told a reason, or what else the job tells of a pixel
void settle(const ChainPicture& picture, const ChainRows& rows, std::uint32_t x, std::uint32_t y, std::uint32_t told);

/// Calls `visit(x, asking)` for the blocks of four rows from `top` that lie in a word of theirs and ask: bits of lanes.
template <typename Visit>
void eachBlock(const ChainRows& rows, std::uint32_t top, std::size_t word, Visit&& visit)
{
    constexpr std::uint32_t side = simd::kBlockSide;
    const std::uint32_t bottom = std::min(top + side, rows.bottom);
    std::uint64_t any = 0;
    for (std::uint32_t y = top; y < bottom; ++y)
        any |= rows.asked.row(y - rows.top)[word];
    while (any != 0) {
        const auto step = static_cast<std::uint32_t>(std::countr_zero(any)) / side * side;
        std::uint32_t asking = 0;
        for (std::uint32_t y = top; y < bottom; ++y)
            asking |= static_cast<std::uint32_t>(rows.asked.row(y - rows.top)[word] >> step & 0xfu) << (y - top) * side;
        visit(static_cast<std::uint32_t>(64 * word) + step, asking);
        any &= ~(std::uint64_t{0xf} << step);
    }
}

/// Answers all that asks in the rows; ChainJob::byBlocks().
void answerRows(const ChainPicture& picture, const ChainRows& rows);

} // namespace gnomon
