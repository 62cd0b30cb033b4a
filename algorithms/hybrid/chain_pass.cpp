#include "algorithms/hybrid/chain_pass.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "algorithms/hybrid/bit_rows.hpp"

namespace gnomon {

namespace {

constexpr std::uint32_t kSide = 4;  // of blocks, in which pixels are asked: neighbours share texels and ways of rays
constexpr std::uint32_t kPiece = 8; // rows of blocks a thread takes at once: enough rays to fill batches

/// What all threads of the pass share.
struct ChainPicture {
    const ChainJob& job;
    const HostContext& host;
    const Receivers& receivers;
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

/// Calls `visit(x, y)` for the pixels that ask of the blocks of four rows from `top` that lie in a word of theirs.
template <typename Visit>
void eachAsking(const ChainRows& rows, std::uint32_t top, std::size_t word, Visit&& visit)
{
    const std::uint32_t bottom = std::min(top + kSide, rows.bottom);
    std::uint64_t any = 0;
    for (std::uint32_t y = top; y < bottom; ++y)
        any |= rows.asked.row(y - rows.top)[word];
    while (any != 0) {
        const auto step = static_cast<std::uint32_t>(std::countr_zero(any)) / kSide * kSide;
        for (std::uint32_t y = top; y < bottom; ++y)
            for (std::uint64_t bits = rows.asked.row(y - rows.top)[word] >> step & 0xfu; bits != 0; bits &= bits - 1)
                visit(static_cast<std::uint32_t>(64 * word + step) + std::uint32_t(std::countr_zero(bits)), y);
        any &= ~(std::uint64_t{0xf} << step);
    }
}

/// A pixel that asks the map. What it will read lies all over the map (at 2048 texels 32 MB, each row of a texel's
/// neighbours on pages of its own), and is called for well before: a pixel takes a fifth less time.
struct Waiting {
    std::uint32_t x, y;
    bool lit;
    ShadowRay ray;
    MapTexels texels;
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

/// Asks no more of what the status pass has seen to; where reasons are told, those of the contour are texels that
/// agree.
void leaveSettled(const ChainPicture& picture, const ChainRows& rows, std::uint32_t y)
{
    const std::span<std::uint64_t> asked = rows.asked.row(y - rows.top);
    const std::span<const std::uint64_t> settled = picture.settled.subspan(y * asked.size(), asked.size());
    for (std::size_t word = 0; word < asked.size(); ++word) {
        std::uint64_t left = picture.job.tells == ChainDebugOutput::reason ? asked[word] & settled[word] : 0;
        asked[word] &= ~settled[word];
        for (; left != 0; left &= left - 1) {
            std::uint8_t& byte =
                rows.at(static_cast<std::uint32_t>(64 * word) + std::uint32_t(std::countr_zero(left)), y);
            if (byte == gpu::REASON_MAP_LIT || byte == gpu::REASON_MAP_SHADOW)
                byte = byte == gpu::REASON_MAP_LIT ? gpu::REASON_TC_LIT : gpu::REASON_TC_SHADOW;
        }
    }
}

/// The bytes of the status pass, and which pixels ask; memory from the arena.
ChainRows rowsOf(const ChainPicture& picture, std::uint32_t top, std::uint32_t bottom)
{
    FrameArena& arena = *picture.host.arena;
    const std::uint32_t width = picture.lit.width, count = bottom - top;
    const std::size_t bytes = std::size_t(count) * width;
    const ChainRows rows{.top = top,
                         .bottom = bottom,
                         .asked = {width, count, arena.array<std::uint64_t>(count * BitRows::wordsPerRow(width))},
                         .bytes = arena.array<std::uint8_t>(bytes)};
    const auto status = picture.host.read<std::uint8_t>(picture.job.status);
    std::memcpy(rows.bytes.data(), status.data() + std::size_t(top) * width, bytes);
    for (std::uint32_t y = top; y < bottom; ++y) {
        const std::span<std::uint64_t> asked = rows.asked.row(y - top);
        if (picture.job.contour == 0)
            fullRow(width, asked);
        else // two pixels are a border itself, every two more a dilation
            contourRow(picture.lit, y, (picture.job.contour - 1) / 2, asked);
        askUnsure(rows.bytes.subspan(std::size_t(y - top) * width, width), asked);
        if (!picture.settled.empty()) leaveSettled(picture, rows, y);
    }
    return rows;
}

/// The pixels of some rows that are asked one by one.
class Pixels {
public:
    Pixels(const ChainPicture& picture, const ChainRows& rows)
        : picture_(picture), rows_(rows),
          candidates_(*picture.job.triangles), scene_{picture.map, picture.job.constants->base,
                                                      picture.job.light->type == GN_LIGHT_TYPE_POINT, candidates_}
    {
    }
    void run();

private:
    void call(std::uint32_t x, std::uint32_t y);
    void askCalled();
    void ask(std::uint32_t x, std::uint32_t y);
    std::uint32_t number(const Waiting& pixel);
    void decide(const Waiting& pixel);
    void show(std::uint32_t x, std::uint32_t y, std::uint32_t told);
    void flush();

    const ChainPicture& picture_;
    const ChainRows& rows_;
    CandidateOccluders candidates_;
    ChainScene scene_;
    // Pixels called for, and of these the ones that ask the map.
    static constexpr std::uint32_t kOnTheWay = 64;
    std::uint32_t called_[kOnTheWay], calledCount_ = 0;
    Waiting waiting_[kOnTheWay];
    std::uint32_t waitingCount_ = 0;
    RayBatch<256> batch_; // the width of RayScene's sparse packets
};

/// @param told a reason, or what else the job tells of a pixel
void Pixels::show(std::uint32_t x, std::uint32_t y, std::uint32_t told)
{
    std::uint8_t& byte = rows_.at(x, y);
    if (picture_.job.tells != ChainDebugOutput::visibility)
        byte = static_cast<std::uint8_t>(told);
    else if (const bool lit = isLit(told); lit != picture_.lit.at(x, y) || byte == gpu::MAP_UNSURE)
        byte = lit ? 255 : 0;
}

void Pixels::flush()
{
    batch_.flush(picture_.host, picture_.job.light->mask, [&](std::uint32_t pixel, bool occluded) {
        show(gpu::pixelX(pixel), gpu::pixelY(pixel), occluded ? gpu::REASON_RT_SHADOW : gpu::REASON_RT_LIT);
    });
}

void Pixels::call(std::uint32_t x, std::uint32_t y)
{
    const VkOffset2D& from = picture_.job.view->area.offset;
    picture_.receivers.prefetch(static_cast<std::uint32_t>(from.x) + x, static_cast<std::uint32_t>(from.y) + y);
    called_[calledCount_++] = gpu::packPixel(x, y);
    if (calledCount_ == kOnTheWay) askCalled();
}

void Pixels::askCalled()
{
    waitingCount_ = 0;
    for (std::uint32_t i = 0; i < calledCount_; ++i)
        ask(gpu::pixelX(called_[i]), gpu::pixelY(called_[i]));
    calledCount_ = 0;
    for (std::uint32_t i = 0; i < waitingCount_; ++i)
        decide(waiting_[i]);
}

void Pixels::ask(std::uint32_t x, std::uint32_t y)
{
    const VkOffset2D& from = picture_.job.view->area.offset;
    Waiting& pixel = waiting_[waitingCount_];
    Receiver receiver;
    const Asked asked = picture_.receivers.at(static_cast<std::uint32_t>(from.x) + x,
                                              static_cast<std::uint32_t>(from.y) + y, pixel.ray, receiver);
    if (asked != Asked::ray) {
        const bool lit = asked == Asked::lit;
        if (picture_.job.tells == ChainDebugOutput::votes)
            show(x, y, lit ? gpu::VOTES_OUTSIDE : gpu::VOTES_BACKFACING);
        else if (tellsAll(picture_.job.tells))
            show(x, y, 0);
        else
            show(x, y, lit ? gpu::REASON_OUTSIDE : gpu::REASON_BACKFACING);
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
std::uint32_t Pixels::number(const Waiting& pixel)
{
    if (picture_.job.tells == ChainDebugOutput::texelCandidates) return texelCandidates(pixel.texels);
    if (picture_.job.tells == ChainDebugOutput::ringCandidates) return ringCandidates(scene_, pixel.texels);
    return chainVotes(scene_, pixel.lit, picture_.receivers.hasNormals(), pixel.texels, pixel.ray);
}

void Pixels::decide(const Waiting& pixel)
{
    if (tellsAll(picture_.job.tells)) {
        show(pixel.x, pixel.y, number(pixel));
        return;
    }
    const std::uint32_t reason =
        chainReason(scene_, picture_.job.stages, pixel.lit, picture_.receivers.hasNormals(), pixel.texels, pixel.ray);
    if (reason != gpu::REASON_RT_LIT) {
        show(pixel.x, pixel.y, reason);
        return;
    }
    batch_.rays[batch_.count] = pixel.ray;
    batch_.tags[batch_.count++] = gpu::packPixel(pixel.x, pixel.y);
    if (batch_.full()) flush();
}

/// In blocks: neighbouring rays share their way through the trees.
void Pixels::run()
{
    for (std::uint32_t top = rows_.top; top < rows_.bottom; top += kSide)
        for (std::size_t word = 0; word < BitRows::wordsPerRow(rows_.asked.width); ++word)
            eachAsking(rows_, top, word, [&](std::uint32_t x, std::uint32_t y) { call(x, y); });
    askCalled();
    flush();
}

void answerPiece(const ChainPicture& picture, std::uint32_t top, std::uint32_t bottom)
{
    const ChainRows rows = rowsOf(picture, top, bottom);
    Pixels(picture, rows).run();
    // Upload memory may be write-combined: all at once.
    std::memcpy(picture.host.write<std::uint8_t>(picture.job.rows).data() + std::size_t(top) * picture.lit.width,
                rows.bytes.data(), rows.bytes.size());
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
    const Receivers receivers(*job.view, *job.light, host.read<float>(job.depth),
                              job.normals ? host.read<std::byte>(job.normals) : std::span<const std::byte>());
    const ChainPicture picture{job,
                               host,
                               receivers,
                               map,
                               litRows(job, host),
                               job.settled ? host.read<std::uint64_t>(job.settled) : std::span<const std::uint64_t>()};
    const std::uint32_t height = picture.lit.height, blockRows = (height + kSide - 1) / kSide;
    host.jobs->parallelFor(blockRows, kPiece, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        answerPiece(picture, static_cast<std::uint32_t>(begin) * kSide,
                    std::min(static_cast<std::uint32_t>(end) * kSide, height));
    });
}

} // namespace gnomon
