#include "algorithms/hybrid/map_classification.hpp"

#include <algorithm>
#include <cstring>
#include <functional>

#include "algorithms/hybrid/block_rays.hpp"
#include "algorithms/shared/receivers.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon {

namespace {

/// What is asked, and by what bytes it is answered.
struct BlockAsking {
    const CameraView& view;
    const LightView& light;
    const HostContext& host;
    const BlockReader& reader;
    simd::MapBytes bytes;
    std::uint8_t rayLit, rayDark;
};

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

/// Answers all pixels of the view's area; what the light does not reach is `outside`.
/// @param map has a type Places; place(x, y, places) finds the receivers of a block, and answer(places, x, y, bytes)
/// says what they show and which of them want rays, bit by bit
/// @param to the area's bytes, row by row
template <typename Map>
void answerByBlocks(const BlockAsking& asking, const Map& map, std::span<std::uint8_t> to)
{
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

/// Receivers by the four texels around them.
struct Voting {
    using Places = simd::MapPlaces;
    const BlockReader& reader;
    const simd::MapLookup& map;
    const simd::MapBytes& bytes;

    void place(std::uint32_t x, std::uint32_t y, Places& places) const { reader.place(x, y, map, places); }
    std::uint32_t answer(const Places& places, std::uint32_t, std::uint32_t,
                         std::uint8_t (&answers)[simd::kLanes]) const
    {
        return reader.kernels().classifyTexels(map, places, bytes, answers);
    }
};

/// Four bits of a word, from `first` on.
void put(std::uint64_t& word, std::uint32_t first, std::uint32_t bits)
{
    word = (word & ~(std::uint64_t{0xf} << first)) | std::uint64_t{bits} << first;
}

/// And by their own texel alone.
struct Nearest : Voting {
    const BitRows& settled;
    Believed believed;

    std::uint32_t answer(const Places& places, std::uint32_t x, std::uint32_t y,
                         std::uint8_t (&answers)[simd::kLanes]) const
    {
        const simd::MapLanes told = reader.kernels().nearest(map, places, bytes, answers);
        const std::uint32_t bits = ~told.asks | (believed == Believed::agreeing     ? told.agree
                                                 : believed == Believed::clearlyLit ? told.clearlyLit
                                                                                    : 0u);
        // Of a thread's own: blocks of one row of them are asked by one.
        for (std::uint32_t row = 0; row < std::min(simd::kBlockSide, settled.height - y); ++row)
            put(settled.row(y + row)[x / 64], x % 64, bits >> row * simd::kBlockSide & 0xfu);
        return 0;
    }
};

constexpr simd::MapBytes kReasonCodes{.outside = gpu::REASON_OUTSIDE,
                                      .backfacing = gpu::REASON_BACKFACING,
                                      .lit = gpu::REASON_TC_LIT,
                                      .dark = gpu::REASON_TC_SHADOW,
                                      .unsure = gpu::REASON_TC_LIT};

BlockReader readerOf(const MapQuestion& question, const HostContext& host)
{
    return BlockReader(widestKernels(), *question.view, *question.light, host.read<float>(question.depth),
                       host.read<std::byte>(question.normals));
}

/// @param asked makes of a Voting what asks
template <typename Asked>
void answer(const MapQuestion& question, const simd::MapBytes& told, bool reasons, const HostContext& host,
            std::span<std::uint8_t> bytes, Asked asked)
{
    const BlockReader reader = readerOf(question, host);
    const simd::MapLookup map = question.map.onHost(host, *question.constants);
    const BlockAsking asking{.view = *question.view,
                             .light = *question.light,
                             .host = host,
                             .reader = reader,
                             .bytes = told,
                             .rayLit = reasons ? std::uint8_t{gpu::REASON_RT_LIT} : std::uint8_t{255},
                             .rayDark = reasons ? std::uint8_t{gpu::REASON_RT_SHADOW} : std::uint8_t{0}};
    answerByBlocks(asking, asked(Voting{reader, map, asking.bytes}), bytes);
}

} // namespace

void MapQuestion::uses(PassRef& host) const
{
    host.reads(depth).reads(normals);
    map.uses(host);
}

void declareMapClassification(PassBuilder& passes, const ShadowTask& task, const ClassificationNames& names,
                              const HostMapCopy& map, const gpu::MapConstants& constants, bool reasons)
{
    const HostVisibility buffers = declareHostVisibility(passes, task, names.visibility);
    const MapQuestion question{.view = task.view,
                               .light = task.light,
                               .constants = &constants,
                               .map = map,
                               .depth = buffers.depth,
                               .normals = buffers.normals};
    PassRef host = passes.host(names.pass);
    question.uses(host);
    host.writes(buffers.rows);
    host.run([question, reasons, rows = buffers.rows](HostContext& context) {
        classifiedPixels(question, reasons, context, context.write<std::uint8_t>(rows));
    });
    declareVisibilityCopy(passes, task, buffers, names.copy);
}

void classifiedPixels(const MapQuestion& question, bool reasons, const HostContext& host, std::span<std::uint8_t> bytes)
{
    answer(question, reasons ? kReasonCodes : kVisibility, reasons, host, bytes, std::identity());
}

void nearestPixels(const MapQuestion& question, const simd::MapBytes& told, const HostContext& host,
                   std::span<std::uint8_t> bytes, const BitRows& settled, Believed believed)
{
    std::fill(settled.words.begin(), settled.words.end(), ~std::uint64_t{0}); // blocks that the light does not reach
    answer(question, told, false, host, bytes, [&](const Voting& base) { return Nearest{base, settled, believed}; });
}

} // namespace gnomon
