#pragma once
// What all volume methods need of a view, made once however many lights ask: the host's depth with a stencil of our own
// beside it, and the bounds of what the camera sees.
#include "runtime/algorithm.hpp"

namespace gnomon {

inline constexpr VkFormat kStencilFormat = VK_FORMAT_D32_SFLOAT_S8_UINT;

struct ViewStencilPipelines {
    PipelineId bounds;
};
ViewStencilPipelines makeViewStencilPipelines(const AlgorithmServices& services);

struct ViewStencil {
    ImageId image;           ///< kStencilFormat, the host's depth bit by bit; stencil undefined.
    BufferId receiverBounds; ///< gpu::ReceiverBounds, relative to the eye; sky left out.
};

/// Declares the copy and the bounds for task.view.
ViewStencil declareViewStencil(PassBuilder& passes, const ViewStencilPipelines& pipelines, const ShadowTask& task);

/// Device bytes of both in a view of this extent.
VkDeviceSize viewStencilMemory(VkExtent2D extent);

} // namespace gnomon
