#include "algorithms/hybrid/block_rays.hpp"

#include <bit>

namespace gnomon {

using simd::kBlockSide;
using simd::kLanes;

void BlockRays::flush()
{
    flushSingles();
    flushPackets();
}

void BlockRays::flushSingles()
{
    batch_.flush(info_.host, info_.light.mask,
                 [&](std::uint32_t at, bool occluded) { bytes_[at] = occluded ? info_.dark : info_.lit; });
}

void BlockRays::flushPackets()
{
    if (packetCount_ == 0) return;
    info_.host.rays->occluded(std::span(packets_, packetCount_), info_.light.mask);
    for (std::uint32_t i = 0; i < packetCount_; ++i) {
        const RayPacket& packet = packets_[i];
        info_.host.countRays(static_cast<std::size_t>(std::popcount(lanes_[i])));
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            if ((lanes_[i] >> lane & 1) == 0) continue;
            const bool blocked = packet.there[lane] != 0 && packet.tfar[lane] < 0.0f;
            bytes_[firsts_[i] + lane / kBlockSide * stride_ + lane % kBlockSide] = blocked ? info_.dark : info_.lit;
        }
    }
    packetCount_ = 0;
}

/// A block's rays side by side as they are.
void BlockRays::askTogether(const simd::Block& block, std::uint32_t lanes, std::size_t first)
{
    RayPacket& packet = packets_[packetCount_];
    info_.reader.pack(block, packet);
    for (std::uint32_t lane = 0; lane < kLanes; ++lane)
        packet.there[lane] &= (lanes >> lane & 1) != 0 ? -1 : 0;
    lanes_[packetCount_] = lanes;
    firsts_[packetCount_++] = first;
    if (packetCount_ == kPackets) flushPackets();
}

void BlockRays::ask(const simd::Block& block, std::uint32_t lanes, std::size_t first)
{
    if (std::popcount(lanes) >= kTogether) {
        askTogether(block, lanes, first);
        return;
    }
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
        batch_.rays[batch_.count] = rayOf(block, lane, info_.light);
        batch_.tags[batch_.count++] =
            static_cast<std::uint32_t>(first + lane / kBlockSide * stride_ + lane % kBlockSide);
        if (batch_.full()) flushSingles();
    }
}

} // namespace gnomon
