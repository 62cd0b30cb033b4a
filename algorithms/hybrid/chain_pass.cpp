#include "algorithms/hybrid/chain_pass.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "algorithms/hybrid/bit_rows.hpp"
#include "algorithms/hybrid/block_answers.hpp"
#include "algorithms/hybrid/block_rays.hpp"
#include "algorithms/hybrid/receivers.hpp"

namespace gnomon {

namespace {

constexpr std::uint32_t kBand = 4;  // rows, and columns of a step: neighbouring rays share their way through the trees
constexpr std::uint32_t kPiece = 8; // bands a thread takes at once: enough rays to fill batches

/// A pixel that asks the map. What it will read lies all over the map (at 2048 texels 32 MB, each row of a texel's
/// neighbours on pages of its own), and is called for well before: a pixel takes a fifth less time.
struct Waiting {
    std::uint32_t x, y;
    bool lit;
    ShadowRay ray;
    MapTexels texels;
};

/// What all pieces share.
struct Picture {
    const ChainJob& job;
    const HostContext& host;
    const Receivers& receivers;
    const BlockReader& blocks;
    const HostMap& map;
    BitRows lit;
    std::span<const std::uint64_t> settled; ///< Rows of bits, or none.
};

/// Adds the pixels that are MAP_UNSURE.
void askUnsure(std::span<const std::uint8_t> bytes, std::span<std::uint64_t> asked)
{
    const auto* next = bytes.data();
    const auto* const end = next + bytes.size();
    while ((next = static_cast<const std::uint8_t*>(
                std::memchr(next, gpu::MAP_UNSURE, static_cast<std::size_t>(end - next))))) {
        const auto x = static_cast<std::size_t>(next++ - bytes.data());
        asked[x / 64] |= std::uint64_t{1} << (x % 64);
    }
}

/// Some rows of the picture.
class Piece {
public:
    Piece(const Picture& picture, std::uint32_t top, std::uint32_t bottom);
    void run();

private:
    void leaveSettled(std::uint32_t y);
    void call(std::uint32_t x, std::uint32_t y);
    void askCalled();
    void ask(std::uint32_t x, std::uint32_t y);
    std::uint32_t number(const Waiting& pixel);
    void decide(const Waiting& pixel);
    void settle(std::uint32_t x, std::uint32_t y, std::uint32_t told);
    void flush();
    template <typename Visit>
    void eachStep(std::uint32_t top, std::uint32_t bottom, std::size_t word, Visit&& visit) const;
    void runBand(std::uint32_t top, std::uint32_t bottom);
    void traceBand(std::uint32_t top, std::uint32_t bottom, BlockRays& rays);
    void trace();

    const Picture& picture_;
    std::uint32_t top_, bottom_;
    BitRows asked_;                ///< Row 0 is `top_`.
    std::span<std::uint8_t> rows_; ///< From row `top_` on.
    Witnesses witnesses_;
    ChainScene scene_;
    // Pixels called for, and of these the ones that ask the map.
    static constexpr std::uint32_t kOnTheWay = 64;
    std::uint32_t called_[kOnTheWay], calledCount_ = 0;
    Waiting waiting_[kOnTheWay];
    std::uint32_t waitingCount_ = 0;
    RayBatch<256> batch_; // the width of RayScene's sparse packets
};

Piece::Piece(const Picture& picture, std::uint32_t top, std::uint32_t bottom)
    : picture_(picture), top_(top), bottom_(bottom),
      witnesses_(*picture.job.triangles), scene_{picture.map, picture.job.constants->base,
                                                 picture.job.light->type == GN_LIGHT_TYPE_POINT, witnesses_}
{
    FrameArena& arena = *picture.host.arena;
    const std::uint32_t width = picture.lit.width, rows = bottom - top;
    asked_ = {width, rows, arena.array<std::uint64_t>(rows * BitRows::wordsPerRow(width))};
    for (std::uint32_t y = top; y < bottom; ++y) {
        if (picture.job.contour == 0)
            fullRow(width, asked_.row(y - top));
        else // two pixels are a border itself, every two more a dilation
            contourRow(picture.lit, y, (picture.job.contour - 1) / 2, asked_.row(y - top));
    }
    const std::size_t bytes = std::size_t(rows) * width;
    rows_ = arena.array<std::uint8_t>(bytes);
    std::memcpy(rows_.data(), picture.host.read<std::uint8_t>(picture.job.status).data() + std::size_t(top) * width,
                bytes);
    for (std::uint32_t y = 0; y < rows; ++y) {
        askUnsure(rows_.subspan(std::size_t(y) * width, width), asked_.row(y));
        if (!picture.settled.empty()) leaveSettled(y);
    }
}

/// Asks no more of what the status pass has seen to; where reasons are told, those of the contour are texels that
/// agree.
void Piece::leaveSettled(std::uint32_t y)
{
    const std::span<std::uint64_t> asked = asked_.row(y);
    const std::span<const std::uint64_t> settled = picture_.settled.subspan((top_ + y) * asked.size(), asked.size());
    for (std::size_t word = 0; word < asked.size(); ++word) {
        std::uint64_t left = picture_.job.tells == ChainTells::reason ? asked[word] & settled[word] : 0;
        asked[word] &= ~settled[word];
        for (; left != 0; left &= left - 1) {
            std::uint8_t& byte = rows_[y * asked_.width + 64 * word + static_cast<std::size_t>(std::countr_zero(left))];
            if (byte == gpu::REASON_MAP_LIT || byte == gpu::REASON_MAP_SHADOW)
                byte = byte == gpu::REASON_MAP_LIT ? gpu::REASON_TC_LIT : gpu::REASON_TC_SHADOW;
        }
    }
}

/// @param told a reason, or what else the job tells of a pixel
void Piece::settle(std::uint32_t x, std::uint32_t y, std::uint32_t told)
{
    std::uint8_t& byte = rows_[std::size_t(y - top_) * picture_.lit.width + x];
    if (picture_.job.tells != ChainTells::visibility)
        byte = static_cast<std::uint8_t>(told);
    else if (const bool lit = isLit(told); lit != picture_.lit.at(x, y) || byte == gpu::MAP_UNSURE)
        byte = lit ? 255 : 0;
}

void Piece::flush()
{
    batch_.flush(
        picture_.host, picture_.job.light->mask, RayCoherence::sparse, [&](std::uint32_t pixel, bool occluded) {
            settle(gpu::pixelX(pixel), gpu::pixelY(pixel), occluded ? gpu::REASON_RT_SHADOW : gpu::REASON_RT_LIT);
        });
}

void Piece::call(std::uint32_t x, std::uint32_t y)
{
    const VkOffset2D& from = picture_.job.view->area.offset;
    picture_.receivers.prefetch(static_cast<std::uint32_t>(from.x) + x, static_cast<std::uint32_t>(from.y) + y);
    called_[calledCount_++] = gpu::packPixel(x, y);
    if (calledCount_ == kOnTheWay) askCalled();
}

void Piece::askCalled()
{
    waitingCount_ = 0;
    for (std::uint32_t i = 0; i < calledCount_; ++i)
        ask(gpu::pixelX(called_[i]), gpu::pixelY(called_[i]));
    calledCount_ = 0;
    for (std::uint32_t i = 0; i < waitingCount_; ++i)
        decide(waiting_[i]);
}

void Piece::ask(std::uint32_t x, std::uint32_t y)
{
    const VkOffset2D& from = picture_.job.view->area.offset;
    Waiting& pixel = waiting_[waitingCount_];
    Receiver receiver;
    const Asked asked = picture_.receivers.at(static_cast<std::uint32_t>(from.x) + x,
                                              static_cast<std::uint32_t>(from.y) + y, pixel.ray, receiver);
    if (asked != Asked::ray) {
        const bool lit = asked == Asked::lit;
        if (picture_.job.tells == ChainTells::votes)
            settle(x, y, lit ? gpu::VOTES_OUTSIDE : gpu::VOTES_BACKFACING);
        else if (tellsAll(picture_.job.tells))
            settle(x, y, 0);
        else
            settle(x, y, lit ? gpu::REASON_OUTSIDE : gpu::REASON_BACKFACING);
        return;
    }
    pixel.x = x;
    pixel.y = y;
    pixel.lit = picture_.lit.at(x, y);
    pixel.texels = MapTexels(scene_.map, scene_.constants, scene_.cube, receiver);
    pixel.texels.prefetch(pixel.lit ? picture_.job.stages.hintLit : picture_.job.stages.hintShadow);
    ++waitingCount_;
}

/// The byte of a job that tells of every pixel.
std::uint32_t Piece::number(const Waiting& pixel)
{
    if (picture_.job.tells == ChainTells::texelCandidates) return texelCandidates(pixel.texels);
    if (picture_.job.tells == ChainTells::ringCandidates) return ringCandidates(scene_, pixel.texels);
    return chainVotes(scene_, pixel.lit, picture_.receivers.hasNormals(), pixel.texels, pixel.ray);
}

void Piece::decide(const Waiting& pixel)
{
    if (tellsAll(picture_.job.tells)) {
        settle(pixel.x, pixel.y, number(pixel));
        return;
    }
    const std::uint32_t reason =
        chainReason(scene_, picture_.job.stages, pixel.lit, picture_.receivers.hasNormals(), pixel.texels, pixel.ray);
    if (reason != gpu::REASON_RT_LIT) {
        settle(pixel.x, pixel.y, reason);
        return;
    }
    batch_.rays[batch_.count] = pixel.ray;
    batch_.tags[batch_.count++] = gpu::packPixel(pixel.x, pixel.y);
    if (batch_.full()) flush();
}

/// Calls `visit(x, asking)` for the blocks of a band that lie in a word of its rows and ask: bits of lanes.
template <typename Visit>
void Piece::eachStep(std::uint32_t top, std::uint32_t bottom, std::size_t word, Visit&& visit) const
{
    static_assert(kBand == lanes::kBlockSide);
    std::uint64_t any = 0;
    for (std::uint32_t y = top; y < bottom; ++y)
        any |= asked_.row(y - top_)[word];
    while (any != 0) {
        const auto step = static_cast<std::uint32_t>(std::countr_zero(any)) / kBand * kBand;
        std::uint32_t asking = 0;
        for (std::uint32_t y = top; y < bottom; ++y)
            asking |= static_cast<std::uint32_t>(asked_.row(y - top_)[word] >> step & 0xfu) << (y - top) * kBand;
        visit(static_cast<std::uint32_t>(64 * word) + step, asking);
        any &= ~(std::uint64_t{0xf} << step);
    }
}

void Piece::runBand(std::uint32_t top, std::uint32_t bottom)
{
    for (std::size_t word = 0; word < BitRows::wordsPerRow(asked_.width); ++word)
        eachStep(top, bottom, word, [&](std::uint32_t x, std::uint32_t asking) {
            for (; asking != 0; asking &= asking - 1) {
                const auto lane = static_cast<std::uint32_t>(std::countr_zero(asking));
                call(x + lane % kBand, top + lane / kBand);
            }
        });
}

/// Sixteen receivers at a time; all that are left in `asked_` are reached by the light and face it.
void Piece::traceBand(std::uint32_t top, std::uint32_t bottom, BlockRays& rays)
{
    for (std::size_t word = 0; word < BitRows::wordsPerRow(asked_.width); ++word) {
        eachStep(top, bottom, word, [&](std::uint32_t x, std::uint32_t) { picture_.blocks.prefetch(x, top); });
        eachStep(top, bottom, word, [&](std::uint32_t x, std::uint32_t asking) {
            lanes::Block block;
            picture_.blocks.read(x, top, block);
            rays.ask(block, asking, std::size_t(top - top_) * asked_.width + x);
        });
    }
}

void Piece::trace()
{
    const bool reasons = picture_.job.tells == ChainTells::reason;
    BlockRays rays({.host = picture_.host,
                    .reader = picture_.blocks,
                    .light = *picture_.job.light,
                    .lit = reasons ? std::uint8_t{gpu::REASON_RT_LIT} : std::uint8_t{255},
                    .dark = reasons ? std::uint8_t{gpu::REASON_RT_SHADOW} : std::uint8_t{0},
                    .together = block_answers::kTogether,
                    .coherence = RayCoherence::sparse},
                   rows_, asked_.width);
    for (std::uint32_t y = top_; y < bottom_; y += kBand)
        traceBand(y, std::min(y + kBand, bottom_), rays);
    rays.flush();
}

void Piece::run()
{
    if (picture_.job.raysAlone()) {
        trace();
    } else {
        for (std::uint32_t y = top_; y < bottom_; y += kBand)
            runBand(y, std::min(y + kBand, bottom_));
        askCalled();
        flush();
    }
    // Upload memory may be write-combined: all at once.
    std::memcpy(picture_.host.write<std::uint8_t>(picture_.job.rows).data() + std::size_t(top_) * picture_.lit.width,
                rows_.data(), rows_.size());
}

BitRows litRows(const ChainJob& job, const HostContext& host)
{
    const VkExtent2D extent = job.view->area.extent;
    const std::span<const std::uint8_t> status = host.read<std::uint8_t>(job.status);
    const BitRows lit{extent.width, extent.height,
                      host.arena->array<std::uint64_t>(extent.height * BitRows::wordsPerRow(extent.width))};
    host.jobs->parallelFor(extent.height, 64, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        for (std::size_t y = begin; y < end; ++y)
            packBits(status.subspan(y * extent.width, extent.width), lit.row(static_cast<std::uint32_t>(y)));
    });
    return lit;
}

} // namespace

void runChain(const ChainJob& job, const HostContext& host)
{
    const HostMap map = job.map.onHost(host);
    const std::span<const float> depth = host.read<float>(job.depth);
    const std::span<const std::byte> normals =
        job.normals ? host.read<std::byte>(job.normals) : std::span<const std::byte>();
    const Receivers receivers(*job.view, *job.light, depth, normals);
    const BlockReader blocks(widestKernels(), *job.view, *job.light, depth, normals);
    const Picture picture{job,
                          host,
                          receivers,
                          blocks,
                          map,
                          litRows(job, host),
                          job.settled ? host.read<std::uint64_t>(job.settled) : std::span<const std::uint64_t>()};
    const std::uint32_t height = picture.lit.height, bands = (height + kBand - 1) / kBand;
    host.jobs->parallelFor(bands, kPiece, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        const auto top = static_cast<std::uint32_t>(begin) * kBand;
        Piece(picture, top, std::min(static_cast<std::uint32_t>(end) * kBand, height)).run();
    });
}

} // namespace gnomon
