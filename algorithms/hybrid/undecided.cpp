#include "algorithms/hybrid/undecided.hpp"

#include <algorithm>
#include <cstring>

#include "algorithms/hybrid/block_rays.hpp"

namespace gnomon {

namespace {

constexpr std::uint32_t kTile = simd::kBlockSide;
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
            const glm::vec3 receiver =
                glm::vec3(view.eyeWs) +
                gpu::linearDepth(view, depths[column]) *
                    gpu::receiverRayWs(view, gpu::viewRayWs(view, glm::vec2(column, row) + 0.5f), depths[column]);
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

/// Pixels by the 4x4 tiles of the view's area that they lie in.
class Tiles {
public:
    Tiles(const VkRect2D& area, std::span<const std::uint32_t> pixels)
        : left_(static_cast<std::uint32_t>(area.offset.x)), top_(static_cast<std::uint32_t>(area.offset.y)),
          pixels_(pixels)
    {
    }
    std::uint32_t left(std::size_t i) const { return (gpu::pixelX(pixels_[i]) - left_) / kTile * kTile; }
    std::uint32_t top(std::size_t i) const { return (gpu::pixelY(pixels_[i]) - top_) / kTile * kTile; }
    std::uint32_t lane(std::size_t i) const
    {
        return (gpu::pixelY(pixels_[i]) - top_) % kTile * kTile + (gpu::pixelX(pixels_[i]) - left_) % kTile;
    }
    /// Calls visit(first, end) for the pixels of each tile. @return how many tiles
    template <typename Visit>
    std::size_t each(Visit&& visit) const
    {
        std::size_t count = 0;
        for (std::size_t i = 0, end = 0; i < pixels_.size(); i = end, ++count) {
            while (end < pixels_.size() && left(end) == left(i) && top(end) == top(i))
                ++end;
            visit(i, end);
        }
        return count;
    }

private:
    std::uint32_t left_, top_;
    std::span<const std::uint32_t> pixels_;
};

/// One ray a pixel.
void trace(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes,
           std::uint8_t lit, std::uint8_t dark)
{
    const Tiles tiles(source.view.area, pixels);
    const std::size_t count = tiles.each([](std::size_t, std::size_t) {});
    const std::span<std::uint8_t> answers = source.host.arena->array<std::uint8_t>(count * simd::kLanes);
    BlockRays rays({.host = source.host, .reader = source.blocks, .light = source.light, .lit = lit, .dark = dark},
                   answers, kTile);
    std::size_t at = 0; // of the tile's answers
    tiles.each([&](std::size_t first, std::size_t end) {
        // Tiles lie all over what was read back.
        const std::size_t ahead = std::min(end + 16, pixels.size() - 1);
        source.blocks.prefetch(tiles.left(ahead), tiles.top(ahead));
        simd::Block block;
        source.blocks.read(tiles.left(first), tiles.top(first), block);
        std::uint32_t asking = 0;
        for (std::size_t i = first; i < end; ++i) {
            const std::uint32_t lane = tiles.lane(i);
            if (block.asked[lane] == simd::kRay) asking |= 1u << lane;
            // CPU and GPU may round n.l to different sides of zero.
            answers[at + lane] = block.asked[lane] == simd::kDark ? dark : lit;
        }
        if (asking != 0) rays.ask(block, asking, at);
        at += simd::kLanes;
    });
    rays.flush();
    at = 0;
    tiles.each([&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i)
            bytes[i] = answers[at + tiles.lane(i)];
        at += simd::kLanes;
    });
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
    trace(source, pixels, bytes, 255, 0);
}

void traceReasons(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes)
{
    trace(source, pixels, bytes, gpu::REASON_RT_LIT, gpu::REASON_RT_SHADOW);
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
