#include "algorithms/hybrid/chain_blocks.hpp"

#include <cmath>

#include "algorithms/hybrid/block_rays.hpp"

namespace gnomon {

namespace {

using simd::kBlockSide;
using simd::kLanes;

constexpr std::uint32_t kAhead = 64 / kBlockSide; // the blocks of a word of bits: theirs is called for at once

/// A block on its way.
struct Waiting {
    std::uint32_t x, asking;
    std::uint32_t lit; ///< Bits, by the map.
    simd::MapPlaces places;
    const std::uint32_t* triangle[kLanes]; ///< Texels that name one, of the dark lanes; null beyond the map.
};

/// The texel in which a receiver lies, called for.
const std::uint32_t* ownTexel(const HostMap& map, const simd::MapPlaces& places, std::uint32_t lane)
{
    const auto column = static_cast<std::int32_t>(std::floor(places.x[lane]));
    const auto row = static_cast<std::int32_t>(std::floor(places.y[lane]));
    const std::span<const std::uint32_t> layer = map.triangle[places.layer[lane]];
    const auto side = static_cast<std::int32_t>(map.side);
    if (layer.empty() || column < 0 || row < 0 || column >= side || row >= side) return nullptr;
    const std::uint32_t* texel = &layer[static_cast<std::size_t>(row) * map.side + static_cast<std::size_t>(column)];
    prefetchRead(texel);
    return texel;
}

/// One thread's rows.
class Blocks {
public:
    Blocks(const ChainPicture& picture, const ChainRows& rows)
        : picture_(picture), rows_(rows), look_(picture.job.map.depthOnHost().onHost(picture.host, constants())),
          candidates_(*picture.job.triangles), rays_(raysOf(picture), rows.bytes, rows.asked.width)
    {
    }
    void run();

private:
    const gpu::MapConstants& constants() const { return picture_.job.constants->base; }
    bool candidates() const { return picture_.job.stages.candidates == CandidateUse::own; }
    static BlockRays::Info raysOf(const ChainPicture& picture);
    std::uint32_t litIn(std::uint32_t x) const;
    std::uint32_t hinted(const Waiting& waiting) const;
    void settleLanes(std::uint32_t x, std::uint32_t lanes, std::uint32_t told);
    std::uint32_t proven(const Waiting& waiting, const simd::Block& block, std::uint32_t lanes);
    void answer(const Waiting& waiting);
    void answerWord(std::size_t word);

    const ChainPicture& picture_;
    const ChainRows& rows_;
    const simd::MapLookup look_;
    CandidateOccluders candidates_;
    BlockRays rays_;
    std::uint32_t top_ = 0; ///< Of the blocks that are asked.
    Waiting waiting_[kAhead];
};

BlockRays::Info Blocks::raysOf(const ChainPicture& picture)
{
    const bool reasons = picture.job.tells == ChainDebugOutput::reason;
    return {.host = picture.host,
            .reader = picture.blocks,
            .light = *picture.job.light,
            .lit = reasons ? std::uint8_t{gpu::REASON_RT_LIT} : std::uint8_t{255},
            .dark = reasons ? std::uint8_t{gpu::REASON_RT_SHADOW} : std::uint8_t{0}};
}

/// What the map says of a block.
std::uint32_t Blocks::litIn(std::uint32_t x) const
{
    std::uint32_t lit = 0;
    for (std::uint32_t y = top_; y < std::min(top_ + kBlockSide, rows_.bottom); ++y)
        lit |= static_cast<std::uint32_t>(picture_.lit.row(y)[x / 64] >> x % 64 & 0xfu) << (y - top_) * kBlockSide;
    return lit;
}

/// Lanes of which the four texels around are believed, where the status pass did not ask for them.
std::uint32_t Blocks::hinted(const Waiting& waiting) const
{
    const Believed believed = picture_.job.settled ? Believed::never : picture_.job.stages.believed();
    if (believed == Believed::never) return 0;
    constexpr simd::MapBytes told{.outside = 0, .backfacing = 0, .lit = 1, .dark = 0, .unsure = 0};
    std::uint8_t own[kLanes];
    const simd::MapLanes lanes = picture_.blocks.kernels().nearest(look_, waiting.places, told, own);
    std::uint32_t lit = 0;
    for (std::uint32_t i = 0; i < kLanes; ++i)
        lit |= std::uint32_t{own[i]} << i;
    // Where the device saw another one of two texels, it is no hint.
    const std::uint32_t agree = ~(lit ^ waiting.lit);
    return agree & (believed == Believed::agreeing ? lanes.agree : lanes.clearlyLit);
}

void Blocks::settleLanes(std::uint32_t x, std::uint32_t lanes, std::uint32_t told)
{
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
        settle(picture_, rows_, x + lane % kBlockSide, top_ + lane / kBlockSide, told);
    }
}

/// Dark lanes that the triangle of their own texel surely blocks.
std::uint32_t Blocks::proven(const Waiting& waiting, const simd::Block& block, std::uint32_t lanes)
{
    std::uint32_t dark = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
        const std::uint32_t* texel = waiting.triangle[lane];
        if (!texel || *texel == kNoTriangle) continue;
        if (candidates_.blocks(*texel, rayOf(block, lane, *picture_.job.light))) dark |= 1u << lane;
    }
    return dark;
}

void Blocks::answer(const Waiting& waiting)
{
    simd::Block block;
    picture_.blocks.read(waiting.x, top_, block);
    std::uint32_t left = waiting.asking, reached[3] = {}; // by simd::kLit, kDark and kRay
    for (std::uint32_t i = 0; i < kLanes; ++i)
        reached[block.asked[i]] |= 1u << i;
    settleLanes(waiting.x, left & reached[simd::kLit], gpu::REASON_OUTSIDE);
    settleLanes(waiting.x, left & reached[simd::kDark], gpu::REASON_BACKFACING);
    left &= reached[simd::kRay];
    const std::uint32_t hints = left & hinted(waiting);
    settleLanes(waiting.x, hints & waiting.lit, gpu::REASON_TC_LIT);
    settleLanes(waiting.x, hints & ~waiting.lit, gpu::REASON_TC_SHADOW);
    left &= ~hints;
    if (candidates()) {
        const std::uint32_t dark = proven(waiting, block, left & ~waiting.lit);
        settleLanes(waiting.x, dark, gpu::REASON_NB_CONFIRMED);
        left &= ~dark;
    }
    if (left != 0) rays_.ask(block, left, std::size_t(top_ - rows_.top) * rows_.asked.width + waiting.x);
}

/// What blocks read is called for well before.
void Blocks::answerWord(std::size_t word)
{
    eachBlock(rows_, top_, word, [&](std::uint32_t x, std::uint32_t) { picture_.blocks.prefetch(x, top_); });
    const bool places = !picture_.job.settled || candidates();
    std::uint32_t count = 0;
    eachBlock(rows_, top_, word, [&](std::uint32_t x, std::uint32_t asking) {
        Waiting& waiting = waiting_[count++];
        waiting.x = x;
        waiting.asking = asking;
        waiting.lit = litIn(x);
        if (places) picture_.blocks.place(x, top_, look_, waiting.places);
        for (std::uint32_t dark = candidates() ? asking & ~waiting.lit : 0; dark != 0; dark &= dark - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(dark));
            waiting.triangle[lane] = ownTexel(picture_.map, waiting.places, lane);
        }
    });
    for (std::uint32_t i = 0; i < count; ++i)
        answer(waiting_[i]);
}

void Blocks::run()
{
    for (std::size_t word = 0; word < BitRows::wordsPerRow(rows_.asked.width); ++word)
        for (top_ = rows_.top; top_ < rows_.bottom; top_ += kBlockSide)
            answerWord(word);
    rays_.flush();
}

} // namespace

void settle(const ChainPicture& picture, const ChainRows& rows, std::uint32_t x, std::uint32_t y, std::uint32_t told)
{
    std::uint8_t& byte = rows.at(x, y);
    if (picture.job.tells != ChainDebugOutput::visibility)
        byte = static_cast<std::uint8_t>(told);
    else if (const bool lit = isLit(told); lit != picture.lit.at(x, y) || byte == gpu::MAP_UNSURE)
        byte = lit ? 255 : 0;
}

void answerRows(const ChainPicture& picture, const ChainRows& rows)
{
    Blocks(picture, rows).run();
}

} // namespace gnomon
