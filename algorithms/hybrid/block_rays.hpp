#pragma once
// Shadow rays of blocks of pixels, put together and answered as bytes.
#include <cstddef>
#include <cstdint>
#include <span>

#include "algorithms/hybrid/tile_blocks.hpp"
#include "algorithms/shared/receivers.hpp"
#include "runtime/rays/ray_packet.hpp"

namespace gnomon {

/// One thread's rays to one light.
class BlockRays {
public:
    /// What stays the same while rows are answered.
    struct Info {
        const HostContext& host;
        const BlockReader& reader;
        const LightView& light;
        std::uint8_t lit, dark; ///< Bytes of the answers.
    };
    /// @param bytes where answers go @param stride from a row of pixels to the next
    BlockRays(const Info& info, std::span<std::uint8_t> bytes, std::size_t stride)
        : info_(info), bytes_(bytes), stride_(stride)
    {
    }

    /// @param lanes bit i: lane i wants an answer; all of these ask @param first place of the block's first pixel
    void ask(const simd::Block& block, std::uint32_t lanes, std::size_t first);
    void flush(); ///< Answers all that was asked.

private:
    static constexpr std::uint32_t kPackets = 16; // asked at once
    // A block with so many lanes that ask is a packet of its own: with 2 as with 4 tracing takes a tenth less than with
    // 8 (conservative_map in colonnade and bench).
    static constexpr int kTogether = RayPacket::kWidth / 4;

    void askTogether(const simd::Block& block, std::uint32_t lanes, std::size_t first);
    void flushPackets();
    void flushSingles();

    const Info info_;
    std::span<std::uint8_t> bytes_;
    std::size_t stride_;
    RayBatch<256> batch_; // the width of RayScene's sparse packets
    RayPacket packets_[kPackets];
    std::uint32_t lanes_[kPackets]; ///< Bit i: lane i of the packet wants an answer.
    std::size_t firsts_[kPackets];
    std::uint32_t packetCount_ = 0;
};

} // namespace gnomon
