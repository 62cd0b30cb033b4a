#pragma once
// Penumbra wedges under the sides of shadow volumes: which are drawn for a light in a view, and their drawing.
#include "algorithms/volumes/volume_draw.hpp"
#include "shaders/volumes/wedge.h"

namespace gnomon {

/// Coverage beyond the stencil's count, and how many edges may have it off by one (wedge.frag, wedge_resolve.frag).
/// Hundreds of edges of a fine mesh add up at a pixel; in sixteen bits that came out wrong by up to a 25th.
inline constexpr VkFormat kCoverageFormat = VK_FORMAT_R32_SFLOAT;

struct WedgePipelines {
    PipelineId before[2], around[2]; ///< By reversed depth; see WedgePlan.
};
WedgePipelines makeWedgePipelines(const AlgorithmServices& services);

/// Null, or why the device cannot add up wedges. Static storage.
const char* missingForWedges(const DeviceTable& vk);

/// What wedge_resolve.frag asks of view and light.
gpu::WedgeResolve wedgeResolve(const CameraView& view, const LightView& light);

/// In the frame's arena.
struct WedgePlan {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    // Of sides, whose lists the wedges read. Casters whose penumbra is clear of the near rectangle, of which the near
    // sides of hulls are drawn, and the others.
    std::span<VolumeDraw> before, around;
    BufferId lists[2]; ///< Null ids: none.
    BufferId receiverBounds;
    BufferId depths; ///< As ViewStencil's.
    std::uint32_t depthColumns = 0;
    bool bounded = true;
    VkRect2D pixels{}; ///< Where the light can reach.
};

/// Those casters of two lists of sides whose penumbra the view can see.
WedgePlan* planWedges(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                      std::span<const VolumeList, 2> sides, bool bounded);

/// Declares the pass that adds up the wedges. @return of kCoverageFormat, by task
ImageId declareWedges(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                      const WedgePlan& plan, const WedgePipelines& pipelines);

} // namespace gnomon
