#pragma once
// What all volume methods need of a view, made once however many lights ask: the host's depth with a stencil of our own
// beside it, and the bounds of what the camera sees.
#include "runtime/algorithm.hpp"
#include "shaders/volumes/volume.h"

namespace gnomon {

inline constexpr VkFormat kStencilFormat = VK_FORMAT_D32_SFLOAT_S8_UINT;

struct ViewStencilPipelines {
    PipelineId bounds;
    PipelineId strips; ///< The same, with the bounds of every strip; only of makeViewStripsPipeline().
};
ViewStencilPipelines makeViewStencilPipelines(const AlgorithmServices& services);
PipelineId makeViewStripsPipeline(const AlgorithmServices& services);

struct ViewStencil {
    ImageId image;           ///< kStencilFormat, the host's depth bit by bit; stencil undefined.
    BufferId receiverBounds; ///< gpu::ReceiverBounds, relative to the eye; sky left out.
    BufferId strips;         ///< gpu::ReceiverBox of every BOUNDS_ROWS pixels of a column, row by row; if asked for.
};

/// Declares the copy and the bounds for task.view; the strips if `pipelines` can make them and they are asked for.
ViewStencil declareViewStencil(PassBuilder& passes, const ViewStencilPipelines& pipelines, const ShadowTask& task,
                               bool strips = false);

/// Strips in a row and in a column of an area of pixels.
VkExtent2D stripExtent(VkExtent2D area);

/// clip = clipFromEye(view) * vec4(positionEs, 1): relative to the eye, in world axes.
glm::mat4 clipFromEye(const CameraView& view);

/// What every shader that draws volumes knows of a light in a view.
/// @param bounded volumes end behind the farthest visible receiver, else at infinity.
gpu::VolumeConstants volumeConstants(const CameraView& view, const LightView& light, bool bounded);

/// Device bytes of copy and bounds in a view of this extent, and of the strips.
VkDeviceSize viewStencilMemory(VkExtent2D extent);
VkDeviceSize stripMemory(VkExtent2D extent);

} // namespace gnomon
