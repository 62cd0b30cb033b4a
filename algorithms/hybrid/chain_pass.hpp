#pragma once
// The host pass of contour_chain: from what the map says of every pixel to what the pixel shows.
#include <cstdint>

#include "algorithms/hybrid/chain.hpp"
#include "algorithms/hybrid/id_map.hpp"

namespace gnomon {

/// What a pixel's byte is.
enum class ChainDebugOutput : std::uint8_t {
    visibility,
    reason, ///< Its REASON_ of shaders/hybrid/reasons.h.
    votes,  ///< VOTE_, of every pixel.
    texelCandidates,
    ringCandidates,
};

/// Everything the pass needs; copied into the frame.
struct ChainJob {
    const CameraView* view;
    const LightView* light;
    const gpu::HybridConstants* constants;
    const NumberedTriangles* triangles;
    IdMap map;
    BufferId depth, normals; ///< Of the view, read back; normals may be null.
    BufferId status;         ///< A byte a pixel of the area; bit 0: the map says lit.
    BufferId settled;        ///< Of nearestPixels(), with the hints that the stages ask for; or null.
    BufferId rows;           ///< Written: the same bytes, but for the pixels that the map is not believed.
    ChainStages stages;
    std::uint32_t contour = 0; ///< Width in pixels; 0: every pixel is asked.
    ChainDebugOutput tells = ChainDebugOutput::visibility;
};

/// Of every pixel that is asked, traced or not: numbers of a byte.
constexpr bool tellsAll(ChainDebugOutput tells)
{
    return tells > ChainDebugOutput::reason;
}

void runChain(const ChainJob& job, const HostContext& host);

} // namespace gnomon
