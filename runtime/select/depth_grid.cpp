#include "runtime/select/depth_grid.hpp"

#include <bit>

#include "runtime/passes/pass_context.hpp"
#include "shaders/runtime_depth_grid_comp.h"

namespace gnomon {

namespace {

struct GridConstants {
    gpu::ViewConstants view;
    glm::uvec4 grid;
    glm::uvec4 size;
};

constexpr BindingInfo kBindings[] = {
    constantsAt(0),
    sampledAt(1, VK_FORMAT_D32_SFLOAT),
    bufferAt(2),
};

std::uint32_t tilesAcross(std::uint32_t pixels)
{
    return (pixels + kTilePixels - 1) / kTilePixels;
}

} // namespace

DepthGrid::~DepthGrid()
{
    for (Measurement& measurement : measurements_)
        memory_.destroy(measurement.buffer->gpu);
}

PipelineId DepthGrid::pipeline(PipelineLibrary& library)
{
    return library.compute({.name = "view.depth_grid",
                            .compute = {.code = k_runtime_depth_grid_comp},
                            .bindings = kBindings,
                            .pushBytes = 0});
}

void DepthGrid::collect(std::uint64_t completedFrame)
{
    for (Measurement& measurement : measurements_) {
        if (measurement.frame == 0 || measurement.frame > completedFrame) continue;
        if (!measurement.stale && measurement.frame > newest_) {
            camera_ = measurement.camera;
            allTiles_ = measurement.tilesX * measurement.tilesY;
            tiles_.reserve(allTiles_); // a steady frame allocates nothing
            const auto* mapped = reinterpret_cast<const DepthTile*>(measurement.buffer->gpu.mapped);
            receiverTiles(camera_, {mapped, allTiles_}, measurement.tilesX, tiles_);
            newest_ = measurement.frame;
            valid_ = true;
        }
        measurement.frame = 0;
    }
}

void DepthGrid::invalidate()
{
    valid_ = false;
    for (Measurement& measurement : measurements_)
        measurement.stale = true;
}

bool DepthGrid::wanted(std::uint64_t frame) const
{
    if (frame % kGridPeriod == 0) return true;
    if (valid_) return false;
    for (const Measurement& measurement : measurements_)
        if (measurement.frame != 0 && !measurement.stale) return false; // one is under way
    return true;
}

Result<void> DepthGrid::declare(PassGraph& graph, const CameraView& view, ImageId depth, PipelineId pipeline,
                                std::uint64_t frame)
{
    const std::uint32_t tilesX = tilesAcross(view.area.extent.width), tilesY = tilesAcross(view.area.extent.height);
    const VkDeviceSize size = std::bit_ceil(VkDeviceSize{tilesX} * tilesY * sizeof(DepthTile));
    Measurement* free = nullptr;
    for (Measurement& measurement : measurements_)
        if (measurement.frame == 0) free = &measurement; // the GPU has done with it
    if (!free) {
        Measurement another;
        another.buffer = std::make_unique<PooledBuffer>();
        another.buffer->place = BufferPlace::readback;
        free = &measurements_.emplace_back(std::move(another));
    }
    if (free->buffer->gpu.size < size) {
        memory_.destroy(free->buffer->gpu);
        Result<GpuBuffer> made =
            memory_.createBuffer(size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::readback, "view.depth_grid");
        if (!made) return made.error();
        free->buffer->gpu = *made;
        free->buffer->sync = free->buffer->savedSync = kFreshSync;
    }
    free->frame = frame;
    free->stale = false;
    free->camera = view;
    free->tilesX = tilesX;
    free->tilesY = tilesY;

    const BufferId tiles = graph.addBuffer(*free->buffer);
    const GridConstants constants{.view = view.constants,
                                  .grid = {tilesX, tilesY, static_cast<std::uint32_t>(view.area.offset.x),
                                           static_cast<std::uint32_t>(view.area.offset.y)},
                                  .size = {view.area.extent.width, view.area.extent.height, 0, 0}};
    PassBuilder(graph)
        .compute("view.depth_grid", Scope::view)
        .samples(depth)
        .writes(tiles)
        .record([=](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, constants), gpu.sampled(1, depth), gpu.storage(2, tiles)});
            gpu.vk->vkCmdDispatch(gpu.cmd, (tilesX + 7) / 8, (tilesY + 7) / 8, 1);
        });
    return {};
}

void DepthGrid::drop(std::uint64_t frame)
{
    for (Measurement& measurement : measurements_)
        if (measurement.frame == frame) measurement.frame = 0;
}

} // namespace gnomon
