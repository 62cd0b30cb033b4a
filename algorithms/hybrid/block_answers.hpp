#pragma once
// Every pixel of a view answered on the CPU, block by block: by a map that is asked for sixteen receivers at once, and
// by rays where it does not know.
#include <algorithm>
#include <cstring>
#include <span>

#include "algorithms/hybrid/block_rays.hpp"
#include "algorithms/shared/receivers.hpp"

namespace gnomon {

/// What is asked, and by what bytes it is answered.
struct BlockAsking {
    const CameraView& view;
    const LightView& light;
    const HostContext& host;
    const BlockReader& reader;
    simd::MapBytes bytes;
    std::uint8_t rayLit, rayDark;
};

namespace block_answers {

// Rows of blocks that a thread takes at once: enough rays to fill batches.
constexpr std::uint32_t kPiece = 8;
// Blocks whose texels are on the way at once: one by one, the pass of `primitives` took a tenth longer.
constexpr std::uint32_t kAhead = 8;

/// Some blocks side by side: texels of all are called for before the first is asked.
/// @param rows bytes from the first block's first pixel on
template <typename Map>
void answerBlocks(const BlockAsking& asking, const Map& map, std::uint32_t left, std::uint32_t top, std::uint32_t right,
                  std::uint8_t* rows, std::size_t first, std::size_t stride, BlockRays& rays)
{
    typename Map::Places places[kAhead];
    const std::uint32_t count = std::min(kAhead, (right - left + simd::kBlockSide - 1) / simd::kBlockSide);
    for (std::uint32_t i = 0; i < count; ++i) {
        asking.reader.prefetch(left + (i + kAhead) * simd::kBlockSide, top);
        map.place(left + i * simd::kBlockSide, top, places[i]);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t x = left + i * simd::kBlockSide;
        std::uint8_t bytes[simd::kLanes];
        std::uint32_t wanting = map.answer(places[i], x, top, bytes);
        const std::size_t at = first + i * simd::kBlockSide;
        for (std::uint32_t y = 0; y < simd::kBlockSide; ++y)
            std::memcpy(rows + at + y * stride, bytes + y * simd::kBlockSide, simd::kBlockSide);
        if (wanting == 0) continue;
        simd::Block block;
        asking.reader.read(x, top, block);
        rays.ask(block, wanting, at);
    }
}

} // namespace block_answers

/// Answers all pixels of the view's area; what the light does not reach is `outside`.
/// @param map has a type Places; place(x, y, places) finds the receivers of a block, and answer(places, x, y, bytes)
/// says what they show and which of them want rays, bit by bit
/// @param to the area's bytes, row by row
template <typename Map>
void answerByBlocks(const BlockAsking& asking, const Map& map, std::span<std::uint8_t> to)
{
    using namespace block_answers;
    constexpr std::uint32_t side = simd::kBlockSide;
    const VkExtent2D extent = asking.view.area.extent;
    const AskedPixels asked = askedPixels(asking.view, asking.light, side);
    const std::size_t stride = (extent.width + side - 1) / side * side; // whole blocks
    const BlockRays::Info info{.host = asking.host,
                               .reader = asking.reader,
                               .light = asking.light,
                               .lit = asking.rayLit,
                               .dark = asking.rayDark};
    auto piece = [&](std::size_t begin, std::size_t end, std::uint32_t) {
        const std::span<std::uint8_t> rows = asking.host.arena->array<std::uint8_t>((end - begin) * side * stride);
        std::fill(rows.begin(), rows.end(), static_cast<std::uint8_t>(asking.bytes.outside));
        BlockRays rays(info, rows, stride);
        for (std::size_t row = begin; row < end; ++row) {
            const auto top = static_cast<std::uint32_t>(row) * side;
            if (!asked.holdsRow(top)) continue;
            for (std::uint32_t left = asked.left; left < asked.right; left += kAhead * side)
                answerBlocks(asking, map, left, top, asked.right, rows.data(), (row - begin) * side * stride + left,
                             stride, rays);
        }
        rays.flush();
        // Upload memory may be write-combined: whole rows at a time.
        const std::size_t top = begin * side, bottom = std::min<std::size_t>(end * side, extent.height);
        for (std::size_t y = top; y < bottom; ++y)
            std::memcpy(&to[y * extent.width], &rows[(y - top) * stride], extent.width);
    };
    asking.host.jobs->parallelFor((extent.height + side - 1) / side, kPiece, piece);
}

} // namespace gnomon
