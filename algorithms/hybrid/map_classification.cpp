#include "algorithms/hybrid/map_classification.hpp"

#include <algorithm>
#include <functional>

#include "algorithms/hybrid/block_answers.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon {

namespace {

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
