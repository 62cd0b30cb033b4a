#include "algorithms/hybrid/undecided.hpp"

#include <algorithm>
#include <cstring>

namespace gnomon {

namespace {

constexpr std::uint32_t kTile = 4;
constexpr std::uint32_t kPiece = 8; // rows of tiles a thread takes at once: enough rays to fill batches

/// Everything the host pass needs; copied into the frame.
struct UndecidedJob {
    const CameraView* view;
    const LightView* light;
    AnswerPixels answer;
    Doubt doubt;
    VkRect2D pixels; ///< What the light reaches, from a tile of the area on, image coordinates.
    BufferId status; ///< Bytes of those pixels as the deciding pass wrote them.
    HostVisibility buffers;
};

/// Some rows of what the light reaches.
struct Rows {
    std::span<std::uint8_t> bytes;
    std::uint32_t left, top; ///< First pixel, image coordinates.
    std::uint32_t width;
};

/// Marks what is not believed.
void doubtRows(const UndecidedJob& job, const HostContext& host, const Rows& rows)
{
    const gpu::ViewConstants& view = job.view->constants;
    const auto [from, extent] = job.doubt.where.pixels;
    const auto x = static_cast<std::uint32_t>(from.x), y = static_cast<std::uint32_t>(from.y);
    const auto below = rows.top + static_cast<std::uint32_t>(rows.bytes.size() / rows.width);
    const std::uint32_t left = std::max(x, rows.left), right = std::min(x + extent.width, rows.left + rows.width);
    for (std::uint32_t row = std::max(y, rows.top); row < std::min(y + extent.height, below); ++row) {
        const std::span<const float> depths =
            host.read<float>(job.buffers.depth).subspan(std::size_t(row) * job.view->extent.width);
        for (std::uint32_t column = left; column < right; ++column) {
            std::uint8_t& byte = rows.bytes[std::size_t(row - rows.top) * rows.width + column - rows.left];
            if (byte != job.doubt.byte || depths[column] == view.skyDepth) continue;
            const glm::vec3 receiver = glm::vec3(view.eyeWs) + gpu::linearDepth(view, depths[column]) *
                                                                   gpu::viewRayWs(view, glm::vec2(column, row) + 0.5f);
            const Aabb& box = job.doubt.where.receivers;
            if (glm::clamp(receiver, box.lower, box.upper) == receiver) byte = gpu::UNDECIDED;
        }
    }
}

/// Answers what is undecided in some rows and hands all of them back.
void answerRows(const UndecidedJob& job, const UndecidedSource& source, std::uint32_t top, std::uint32_t bottom)
{
    const HostContext& host = source.host;
    const std::uint32_t width = job.pixels.extent.width;
    const std::size_t first = std::size_t(top) * width, count = std::size_t(bottom - top) * width;
    // Upload memory may be write-combined: a copy is changed, and handed over at once.
    const std::span<std::uint8_t> bytes = host.arena->array<std::uint8_t>(count);
    std::memcpy(bytes.data(), host.read<std::uint8_t>(job.status).data() + first, count);

    const auto left = static_cast<std::uint32_t>(job.pixels.offset.x);
    const auto above = static_cast<std::uint32_t>(job.pixels.offset.y) + top;
    doubtRows(job, host, {bytes, left, above, width});
    const auto undecided =
        static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), std::uint8_t{gpu::UNDECIDED}));
    const std::span<std::uint32_t> pixels = host.arena->array<std::uint32_t>(undecided);
    findUndecided(bytes, width, left, above, pixels);
    const std::span<std::uint8_t> answers = host.arena->array<std::uint8_t>(undecided);
    job.answer(source, pixels, answers);
    for (std::size_t i = 0; i < undecided; ++i)
        bytes[std::size_t(gpu::pixelY(pixels[i]) - above) * width + gpu::pixelX(pixels[i]) - left] = answers[i];
    std::memcpy(host.write<std::uint8_t>(job.buffers.rows).data() + first, bytes.data(), count);
}

void answerAll(const UndecidedJob& job, const HostContext& host)
{
    const Receivers receivers = receiversOf(*job.view, *job.light, job.buffers, host);
    const BlockReader blocks = blocksOf(*job.view, *job.light, job.buffers, host);
    const UndecidedSource source{*job.view, *job.light, host, receivers, blocks};
    const std::uint32_t height = job.pixels.extent.height, tileRows = (height + kTile - 1) / kTile;
    host.jobs->parallelFor(tileRows, kPiece, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        answerRows(job, source, static_cast<std::uint32_t>(begin) * kTile,
                   std::min(static_cast<std::uint32_t>(end) * kTile, height));
    });
}

/// One ray a pixel: tiles with some pixels as packets, single pixels as a stream of rays.
class HardRays {
public:
    HardRays(const UndecidedSource& source, std::span<std::uint8_t> bytes, std::uint8_t lit, std::uint8_t dark)
        : source_(source), bytes_(bytes), lit_(lit), dark_(dark)
    {
    }
    void run(std::span<const std::uint32_t> pixels);

private:
    // A quarter of a packet: with 2 pixels as with 4 tracing takes a tenth less than with 8 (conservative_map in
    // colonnade and bench).
    static constexpr std::size_t kTogether = RayPacket::kWidth / 4;
    static constexpr std::uint32_t kPackets = 16; // asked at once

    std::uint32_t tileOf(std::uint32_t pixel) const;
    void askTile(std::span<const std::uint32_t> pixels, std::uint32_t first);
    void ask(std::uint32_t pixel, std::uint32_t at);
    void flush();
    void flushPackets();

    const UndecidedSource& source_;
    std::span<std::uint8_t> bytes_;
    std::uint8_t lit_, dark_;
    RayBatch<256> batch_; // the width of RayScene's sparse packets
    RayPacket packets_[kPackets];
    std::uint8_t lanes_[kPackets][RayPacket::kWidth]; ///< Of the pixels that a packet answers.
    std::uint32_t firsts_[kPackets], counts_[kPackets];
    std::uint32_t packetCount_ = 0;
};

/// Place of the pixel's tile in the area.
std::uint32_t HardRays::tileOf(std::uint32_t pixel) const
{
    const VkOffset2D& from = source_.view.area.offset;
    return gpu::packPixel((gpu::pixelX(pixel) - static_cast<std::uint32_t>(from.x)) / kTile,
                          (gpu::pixelY(pixel) - static_cast<std::uint32_t>(from.y)) / kTile);
}

void HardRays::flush()
{
    batch_.flush(source_.host, source_.light.mask,
                 [&](std::uint32_t i, bool occluded) { bytes_[i] = occluded ? dark_ : lit_; });
}

void HardRays::flushPackets()
{
    source_.host.rays->occluded(std::span(packets_, packetCount_), source_.light.mask);
    for (std::uint32_t p = 0; p < packetCount_; ++p) {
        for (std::uint32_t i = 0; i < counts_[p]; ++i) {
            const std::uint32_t lane = lanes_[p][i];
            if (packets_[p].there[lane] != 0 && packets_[p].tfar[lane] < 0.0f) bytes_[firsts_[p] + i] = dark_;
        }
    }
    packetCount_ = 0;
}

/// Pixels of one tile. @param first of them
void HardRays::askTile(std::span<const std::uint32_t> pixels, std::uint32_t first)
{
    const std::uint32_t tile = tileOf(pixels[0]);
    const std::uint32_t left = gpu::pixelX(tile) * kTile, top = gpu::pixelY(tile) * kTile;
    const VkOffset2D& from = source_.view.area.offset;
    simd::Block block;
    source_.blocks.read(left, top, block);
    RayPacket& packet = packets_[packetCount_];
    source_.blocks.pack(block, packet);
    std::int32_t wanted[RayPacket::kWidth] = {};
    std::size_t rays = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const std::uint32_t x = gpu::pixelX(pixels[i]) - static_cast<std::uint32_t>(from.x) - left;
        const std::uint32_t y = gpu::pixelY(pixels[i]) - static_cast<std::uint32_t>(from.y) - top;
        const std::uint32_t lane = y * kTile + x;
        lanes_[packetCount_][i] = static_cast<std::uint8_t>(lane);
        wanted[lane] = -1;
        bytes_[first + i] = block.asked[lane] == simd::kDark ? dark_ : lit_;
        rays += block.asked[lane] == simd::kRay;
    }
    for (std::uint32_t lane = 0; lane < RayPacket::kWidth; ++lane)
        packet.there[lane] &= wanted[lane];
    source_.host.countRays(rays);
    firsts_[packetCount_] = first;
    counts_[packetCount_++] = static_cast<std::uint32_t>(pixels.size());
    if (packetCount_ == kPackets) flushPackets();
}

void HardRays::ask(std::uint32_t pixel, std::uint32_t at)
{
    const Asked asked = source_.receivers.at(gpu::pixelX(pixel), gpu::pixelY(pixel), batch_.rays[batch_.count]);
    bytes_[at] = asked == Asked::dark ? dark_ : lit_; // CPU and GPU may round n.l to different sides of zero
    if (asked != Asked::ray) return;
    batch_.tags[batch_.count++] = at;
    if (batch_.full()) flush();
}

void HardRays::run(std::span<const std::uint32_t> pixels)
{
    // Receivers lie all over what was read back, and are called for this many pixels before.
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < pixels.size();) {
        std::size_t end = i + 1;
        while (end < pixels.size() && tileOf(pixels[end]) == tileOf(pixels[i]))
            ++end;
        for (std::size_t next = i + ahead; next < std::min(end + ahead, pixels.size()); ++next)
            source_.receivers.prefetch(gpu::pixelX(pixels[next]), gpu::pixelY(pixels[next]));
        if (end - i >= kTogether)
            askTile(pixels.subspan(i, end - i), static_cast<std::uint32_t>(i));
        else
            for (std::size_t at = i; at < end; ++at)
                ask(pixels[at], static_cast<std::uint32_t>(at));
        i = end;
    }
    flush();
    flushPackets();
}

/// Whether one of eight bytes is UNDECIDED.
bool anyUndecided(const std::uint8_t* bytes)
{
    constexpr std::uint64_t ones = 0x0101010101010101ull;
    std::uint64_t word;
    std::memcpy(&word, bytes, sizeof word);
    word ^= ones * gpu::UNDECIDED;
    return ((word - ones) & ~word & ones << 7) != 0; // a byte of it is 0
}

} // namespace

void traceHard(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes)
{
    HardRays(source, bytes, 255, 0).run(pixels);
}

void traceReasons(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes)
{
    HardRays(source, bytes, gpu::REASON_RT_LIT, gpu::REASON_RT_SHADOW).run(pixels);
}

std::size_t findUndecided(std::span<const std::uint8_t> bytes, std::uint32_t width, std::uint32_t x, std::uint32_t y,
                          std::span<std::uint32_t> list)
{
    const auto rows = static_cast<std::uint32_t>(bytes.size() / width);
    std::size_t count = 0;
    const auto tile = [&](std::uint32_t left, std::uint32_t top) {
        for (std::uint32_t row = top; row < std::min(top + kTile, rows); ++row)
            for (std::uint32_t column = left; column < std::min(left + kTile, width); ++column)
                if (bytes[std::size_t(row) * width + column] == gpu::UNDECIDED)
                    list[count++] = gpu::packPixel(x + column, y + row);
    };
    constexpr std::uint32_t step = 2 * kTile; // columns a word
    for (std::uint32_t top = 0; top < rows; top += kTile) {
        for (std::uint32_t left = 0; left < width; left += step) {
            bool any = left + step > width;
            for (std::uint32_t row = top; row < std::min(top + kTile, rows) && !any; ++row)
                any = anyUndecided(&bytes[std::size_t(row) * width + left]);
            for (std::uint32_t column = left; column < left + step && any; column += kTile)
                tile(column, top);
        }
    }
    return count;
}

namespace {

/// What the light reaches of the area, from the first pixel of a tile on.
VkRect2D pixelsOf(const ShadowTask& task)
{
    const AskedPixels asked = askedPixels(*task.view, *task.light, kTile);
    const VkOffset2D& from = task.view->area.offset;
    return {{from.x + static_cast<std::int32_t>(asked.left), from.y + static_cast<std::int32_t>(asked.top)},
            {asked.right - asked.left, asked.bottom - asked.top}};
}

} // namespace

void declareUndecided(PassBuilder& passes, const ShadowTask& task, const UndecidedNames& names, AnswerPixels answer,
                      const Doubt& doubt)
{
    const VkExtent2D extent = task.view->area.extent;
    const UndecidedJob job{
        .view = task.view,
        .light = task.light,
        .answer = answer,
        .doubt = doubt,
        .pixels = pixelsOf(task),
        .status = passes.transient(BufferInfo{
            .name = names.status, .size = VkDeviceSize(extent.width) * extent.height, .place = BufferPlace::readback}),
        .buffers = declareHostVisibility(passes, task, names.visibility),
    };
    if (job.pixels.extent.width == 0 || job.pixels.extent.height == 0) return; // all of it is lit
    declareVisibilityReadback(passes, task, job.status, job.pixels, names.readback);
    PassRef host = passes.host(names.trace);
    host.reads(job.status);
    useHostVisibility(host, job.buffers);
    host.run([job](HostContext& context) { answerAll(job, context); });
    declareVisibilityCopy(passes, task, job.buffers.rows, job.pixels, names.copy);
}

} // namespace gnomon
