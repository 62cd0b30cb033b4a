#pragma once
// The depth grid of a view: measured on the GPU, read when its frame is completed, never waited for.
#include <memory>
#include <vector>

#include "runtime/passes/pass_graph.hpp"
#include "runtime/select/facts.hpp"
#include "runtime/vk/pipeline_store.hpp"

namespace gnomon {

/// One frame in eight is measured; a receiver moves little in 0.13 s, and a grid costs about one nearest-filter pass.
constexpr std::uint64_t kGridPeriod = 8;

class DepthGrid {
public:
    explicit DepthGrid(DeviceMemory& memory) : memory_(memory) {}
    ~DepthGrid();
    DepthGrid(const DepthGrid&) = delete;
    DepthGrid& operator=(const DepthGrid&) = delete;

    static PipelineId pipeline(PipelineLibrary& library);

    /// Takes over the newest completed measurement.
    void collect(std::uint64_t completedFrame);
    /// The camera jumped or the size changed: nothing measured so far applies.
    void invalidate();
    bool wanted(std::uint64_t frame) const;
    /// Declares the pass (view scope) if a buffer is free.
    Result<void> declare(PassGraph& graph, const CameraView& view, ImageId depth, PipelineId pipeline,
                         std::uint64_t frame);
    /// The measuring frame was withdrawn.
    void drop(std::uint64_t frame);

    bool valid() const { return valid_; }
    std::span<const ReceiverTile> tiles() const { return tiles_; } ///< Without sky.
    std::uint32_t allTiles() const { return allTiles_; }
    const CameraView& camera() const { return camera_; }

private:
    struct Measurement {
        std::unique_ptr<PooledBuffer> buffer;
        std::uint64_t frame = 0; ///< In flight since; 0: free.
        bool stale = false;      ///< Made before the last jump.
        CameraView camera;
        std::uint32_t tilesX = 0, tilesY = 0;
    };
    DeviceMemory& memory_;
    std::vector<Measurement> measurements_;
    std::vector<ReceiverTile> tiles_;
    CameraView camera_;
    std::uint32_t allTiles_ = 0;
    bool valid_ = false;
    std::uint64_t newest_ = 0;
};

} // namespace gnomon
