#pragma once
// The host pass of contour_chain: from what the map says of every pixel to the pixels of which it is to be told
// otherwise.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/chain.hpp"
#include "algorithms/hybrid/id_map.hpp"
#include "algorithms/hybrid/point_marks.hpp"

namespace gnomon {

/// Everything the pass needs; copied into the frame.
struct ChainJob {
    const CameraView* view;
    const LightView* light;
    const gpu::HybridConstants* constants;
    const NumberedTriangles* triangles;
    IdMap map;
    BufferId depth, normals;     ///< Of the view, read back; normals may be null.
    BufferId status;             ///< A byte a pixel of the area; bit 0: the map says lit.
    BufferId marks;              ///< Written: packed pixels.
    std::span<MarkRange> ranges; ///< Written: parts of `marks`, one per byte that a pixel can have.
    ChainStages stages;
    std::uint32_t contour = 0; ///< Width in pixels; 0: every pixel is asked.
    bool reasons = false;      ///< The byte is not visibility, but why: a reason or, with `votes`, votes.
    bool votes = false;
};

/// A range for every reason, or for every set of votes.
constexpr std::size_t markRanges(bool votes)
{
    return votes ? 256 : gpu::REASON_COUNT;
}

void runChain(const ChainJob& job, const HostContext& host);

} // namespace gnomon
