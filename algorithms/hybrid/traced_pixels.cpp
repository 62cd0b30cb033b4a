#include "algorithms/hybrid/traced_pixels.hpp"

#include <algorithm>
#include <cstring>

#include "algorithms/hybrid/host_blocks.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon {

namespace {

using simd::kBlockSide;
using simd::kLanes;

/// The bytes of visibility that a pixel can show.
struct Shades {
    std::uint8_t lit = 255, dark = 0;            ///< Pixels that ask nothing.
    std::uint8_t unoccluded = 255, occluded = 0; ///< What a ray said.
};

constexpr Shades kReasonCodes{.lit = gpu::REASON_OUTSIDE,
                              .dark = gpu::REASON_BACKFACING,
                              .unoccluded = gpu::REASON_RT_LIT,
                              .occluded = gpu::REASON_RT_SHADOW};

/// Everything the host pass needs; copied into the frame.
struct TraceJob {
    const CameraView* view;
    const LightView* light;
    HostVisibility buffers;
    Shades shades;
};

// Blocks in a row whose rays are asked at once.
constexpr std::uint32_t kBlocks = 16;

/// Writes what is known of a block's pixels. @param packet its rays, answered @param first of its pixels in rows
void show(const Shades& shades, const simd::Block& block, const RayPacket& packet, std::uint8_t* first,
          std::uint32_t stride)
{
    const std::uint32_t lit = shades.lit, dark = shades.dark;
    const std::uint32_t unoccluded = shades.unoccluded, occluded = shades.occluded;
    std::int32_t ends[kLanes]; // signs as integers: comparing floats is kept lane by lane, since it may trap
    static_assert(sizeof ends == sizeof packet.tfar);
    std::memcpy(ends, packet.tfar, sizeof ends);
    std::uint32_t words[kLanes]; // vectors of words first
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        const std::uint32_t said = (ends[lane] & packet.there[lane]) < 0 ? occluded : unoccluded;
        const std::uint32_t asked = block.asked[lane];
        words[lane] = asked == simd::kRay ? said : asked == simd::kDark ? dark : lit;
    }
    std::uint8_t bytes[kLanes];
    for (std::uint32_t lane = 0; lane < kLanes; ++lane)
        bytes[lane] = static_cast<std::uint8_t>(words[lane]);
    for (std::uint32_t y = 0; y < kBlockSide; ++y)
        std::memcpy(first + std::size_t(y) * stride, bytes + y * kBlockSide, kBlockSide);
}

/// Answers a row of blocks: the pixels of one share their way through the trees.
void traceBlocks(const TraceJob& job, const HostContext& host, const BlockReader& reader, const AskedPixels& asked,
                 std::uint32_t top, std::span<std::uint8_t> rows, std::uint32_t stride)
{
    simd::Block blocks[kBlocks];
    RayPacket packets[kBlocks] = {};
    std::uint32_t packetOf[kBlocks] = {}; // any, of a block without rays
    for (std::uint32_t left = asked.left; left < asked.right; left += kBlocks * kBlockSide) {
        const std::uint32_t count = std::min(kBlocks, (asked.right - left + kBlockSide - 1) / kBlockSide);
        std::size_t rays = 0, packetCount = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            reader.read(left + i * kBlockSide, top, blocks[i]);
            if (blocks[i].rays == 0) continue;
            packetOf[i] = static_cast<std::uint32_t>(packetCount);
            reader.pack(blocks[i], packets[packetCount++]);
            rays += blocks[i].rays;
        }
        for (std::uint32_t i = count; i < 2 * count; ++i) // arrives while these are traced
            reader.prefetch(left + i * kBlockSide, top);
        if (rays > 0) host.rays->occluded(std::span(packets, packetCount), job.light->mask);
        host.countRays(rays);
        for (std::uint32_t i = 0; i < count; ++i)
            show(job.shades, blocks[i], packets[packetOf[i]], &rows[left + i * kBlockSide], stride);
    }
}

void trace(const TraceJob& job, const HostContext& host)
{
    const VkExtent2D extent = job.view->area.extent;
    const BlockReader reader = blocksOf(*job.view, *job.light, job.buffers, host);
    const AskedPixels asked = askedPixels(*job.view, *job.light, kBlockSide);
    const std::span<std::uint8_t> visibility = host.write<std::uint8_t>(job.buffers.rows);
    const std::uint32_t blockRows = (extent.height + kBlockSide - 1) / kBlockSide;
    const std::uint32_t stride = (extent.width + kBlockSide - 1) / kBlockSide * kBlockSide;
    host.jobs->parallelFor(blockRows, 4, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        // Upload memory may be write-combined: whole rows at a time.
        const std::span<std::uint8_t> rows = host.arena->array<std::uint8_t>(std::size_t(kBlockSide) * stride);
        bool filled = false; // with what no block overwrites
        for (std::size_t row = begin; row < end; ++row) {
            const auto top = static_cast<std::uint32_t>(row) * kBlockSide;
            if (!filled || !asked.holdsRow(top)) std::fill(rows.begin(), rows.end(), job.shades.lit);
            filled = true;
            if (asked.holdsRow(top)) traceBlocks(job, host, reader, asked, top, rows, stride);
            for (std::uint32_t y = 0; y < std::min(kBlockSide, extent.height - top); ++y)
                std::copy_n(rows.begin() + std::ptrdiff_t(y) * stride, extent.width,
                            visibility.begin() + std::ptrdiff_t(top + y) * extent.width);
        }
    });
}

} // namespace

void declareTracedPixels(PassBuilder& passes, const ShadowTask& task, const TracedNames& names, bool reasons)
{
    const TraceJob job{.view = task.view,
                       .light = task.light,
                       .buffers = declareHostVisibility(passes, task, names.visibility),
                       .shades = reasons ? kReasonCodes : Shades{}};
    PassRef host = passes.host(names.trace);
    useHostVisibility(host, job.buffers);
    host.run([job](HostContext& context) { trace(job, context); });
    declareVisibilityCopy(passes, task, job.buffers, names.copy);
}

} // namespace gnomon
