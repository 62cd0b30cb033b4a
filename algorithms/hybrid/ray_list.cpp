#include "algorithms/hybrid/ray_list.hpp"

#include <algorithm>

#include "algorithms/hybrid/pixel_list.hpp"
#include "algorithms/hybrid/receivers.hpp"

namespace gnomon {

namespace {

/// Everything the host pass needs; copied into the frame.
struct TraceJob {
    const CameraView* view;
    const LightView* light;
    RayList list;
    MarkRange* umbra; ///< Of this frame; read when the points are drawn.
};

/// Traces the pixels of a part of the list; blocked[i] answers pixels[i].
void traceList(const TraceJob& job, const HostContext& host, const Receivers& receivers,
               std::span<const std::uint32_t> pixels, std::span<std::uint8_t> blocked)
{
    RayBatch<256> batch; // the width of RayScene's sparse packets
    const auto answer = [&](std::uint32_t i, bool occluded) { blocked[i] = occluded; };
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        const Asked asked = receivers.at(gpu::pixelX(pixels[i]), gpu::pixelY(pixels[i]), batch.rays[batch.count]);
        blocked[i] = asked == Asked::dark; // CPU and GPU may round n.l to different sides of zero
        if (asked != Asked::ray) continue;
        batch.tags[batch.count++] = i;
        if (batch.full()) batch.flush(host, job.light->mask, RayCoherence::sparse, answer);
    }
    batch.flush(host, job.light->mask, RayCoherence::sparse, answer);
}

void trace(const TraceJob& job, const HostContext& host)
{
    const std::span<const std::uint32_t> list = host.read<std::uint32_t>(job.list.pixels);
    const std::uint32_t count = std::min(list[0], job.list.capacity);
    const std::span<const std::uint32_t> pixels = inTileOrder(list.subspan(1, count), job.view->extent, *host.arena);
    const std::span<std::uint8_t> blocked = host.arena->array<std::uint8_t>(count);
    const Receivers receivers(*job.view, *job.light, host.read<float>(job.list.depth),
                              job.list.normals ? host.read<std::byte>(job.list.normals) : std::span<const std::byte>());
    host.jobs->parallelFor(count, 2048, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        traceList(job, host, receivers, pixels.subspan(begin, end - begin), blocked.subspan(begin, end - begin));
    });

    const std::span<std::uint32_t> umbra = host.write<std::uint32_t>(job.list.umbra);
    std::uint32_t written = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (blocked[i]) umbra[written++] = pixels[i];
    }
    job.umbra->count = written;
}

} // namespace

RayLists::RayLists(const AlgorithmServices& services, const RayListNames& names)
    : names_(names), points_(services, names.umbra)
{
}

RayList RayLists::open(PassBuilder& passes, const ShadowTask& task, bool reasons) const
{
    const VkExtent2D extent = task.view->area.extent;
    const std::uint32_t pixels = extent.width * extent.height;
    const RayList list{
        .pixels = passes.transient(BufferInfo{.name = names_.list,
                                              .size = sizeof(std::uint32_t) * (VkDeviceSize(pixels) + 1),
                                              .place = BufferPlace::readback}),
        .umbra = passes.transient(BufferInfo{
            .name = names_.umbra, .size = sizeof(std::uint32_t) * VkDeviceSize(pixels), .place = BufferPlace::upload}),
        .depth = passes.depthOnHost(),
        .normals = passes.normalsOnHost(),
        .capacity = pixels,
        .reasons = reasons,
    };
    passes.transfer(names_.clear).writes(list.pixels).record([buffer = list.pixels](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(buffer), 0, sizeof(std::uint32_t), 0);
    });
    return list;
}

void RayLists::close(PassBuilder& passes, const ShadowTask& task, const RayList& list) const
{
    MarkRange* umbra = passes.arena().make<MarkRange>();
    umbra->value = list.reasons ? static_cast<float>(gpu::REASON_RT_SHADOW) / 255.0f : 0.0f;
    const TraceJob job{.view = task.view, .light = task.light, .list = list, .umbra = umbra};
    PassRef host = passes.host(names_.trace);
    host.reads(list.pixels).reads(list.depth).writes(list.umbra);
    if (list.normals) host.reads(list.normals);
    host.run([job](HostContext& context) { trace(job, context); });
    points_.declare(passes, task, list.umbra, {umbra, 1});
}

} // namespace gnomon
