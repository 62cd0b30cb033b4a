#include "algorithms/hybrid/traced_pixels.hpp"

#include <algorithm>

#include "algorithms/hybrid/host_visibility.hpp"
#include "shaders/hybrid/ray_list.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kTile = 4; // pixels a side: neighbours share their way through the trees

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

void traceTileRow(const TraceJob& job, const HostContext& host, const Receivers& receivers, std::uint32_t top,
                  std::span<std::uint8_t> rows)
{
    const VkRect2D& area = job.view->area;
    const std::uint32_t width = area.extent.width, height = std::min(kTile, area.extent.height - top);
    const auto answer = [&](std::uint32_t pixel, bool occluded) {
        rows[pixel] = occluded ? job.shades.occluded : job.shades.unoccluded;
    };
    RayBatch<512> batch;
    for (std::uint32_t left = 0; left < width; left += kTile) {
        const std::uint32_t right = std::min(left + kTile, width);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = left; x < right; ++x) {
                const auto imageX = static_cast<std::uint32_t>(area.offset.x) + x;
                const auto imageY = static_cast<std::uint32_t>(area.offset.y) + top + y;
                const Asked asked = receivers.at(imageX, imageY, batch.rays[batch.count]);
                rows[y * width + x] = asked == Asked::lit ? job.shades.lit : job.shades.dark;
                if (asked != Asked::ray) continue;
                batch.tags[batch.count++] = y * width + x;
                if (batch.full()) batch.flush(host, job.light->mask, RayCoherence::tiles, answer);
            }
        }
    }
    batch.flush(host, job.light->mask, RayCoherence::tiles, answer);
}

void trace(const TraceJob& job, const HostContext& host)
{
    const VkExtent2D extent = job.view->area.extent;
    const Receivers receivers = receiversOf(*job.view, *job.light, job.buffers, host);
    const std::span<std::uint8_t> visibility = host.write<std::uint8_t>(job.buffers.rows);
    const std::uint32_t tileRows = (extent.height + kTile - 1) / kTile;
    host.jobs->parallelFor(tileRows, 4, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        // Upload memory may be write-combined: whole rows at a time.
        const std::span<std::uint8_t> rows = host.arena->array<std::uint8_t>(std::size_t(kTile) * extent.width);
        for (std::size_t row = begin; row < end; ++row) {
            const auto top = static_cast<std::uint32_t>(row) * kTile;
            traceTileRow(job, host, receivers, top, rows);
            const std::size_t count = std::size_t(std::min(kTile, extent.height - top)) * extent.width;
            std::copy_n(rows.begin(), count, visibility.begin() + std::ptrdiff_t(top) * extent.width);
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
