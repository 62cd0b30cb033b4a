#pragma once
// What all volume methods need of a view, made once however many lights ask: the host's depth with a stencil of our own
// beside it, and the bounds of what the camera sees.
#include "runtime/algorithm.hpp"
#include "shaders/volumes/volume.h"

namespace gnomon {

inline constexpr VkFormat kStencilFormat = VK_FORMAT_D32_SFLOAT_S8_UINT;

/// Null, or which format of the view's copy the device lacks: Vulkan promises only one of two with a stencil. Static
/// storage.
const char* missingForStencil(const DeviceTable& vk);

struct ViewStencilPipelines {
    PipelineId strips, tiles;
};
ViewStencilPipelines makeViewStencilPipelines(const AlgorithmServices& services);

struct ViewStencil {
    ImageId image;                  ///< kStencilFormat: the host's depth, lifted (receiver_tile.h); stencil undefined.
    BufferId depths;                ///< The same depths as floats, row by row.
    std::uint32_t depthColumns = 0; ///< In a row of `depths`.
    BufferId receiverBounds;        ///< gpu::ReceiverBounds, relative to the eye; sky left out.
    BufferId tiles;                 ///< gpu::ReceiverTile, row by row.
};

/// Declares all of it for task.view.
ViewStencil declareViewStencil(PassBuilder& passes, const ViewStencilPipelines& pipelines, const ShadowTask& task);

/// Whether a shader can read a buffer of that size: buffers grow to a power of two and are bound up to it.
inline bool fitsBinding(const DeviceTable& vk, VkDeviceSize bytes)
{
    return pooledSize(bytes) <= vk.properties.limits.maxStorageBufferRange;
}

/// Why the device cannot make it of a view, or null. Static storage.
const char* refusesView(const DeviceTable& vk, const CameraView& view);

/// Tiles in a row and in a column of an area of pixels.
VkExtent2D tileExtent(const VkRect2D& area);

/// clip = clipFromEye(view) * vec4(positionEs, 1): relative to the eye, in world axes.
glm::mat4 clipFromEye(const CameraView& view);

/// Whether the view shows everything mirrored, as that of a planar reflection: what is wound counter-clockwise in the
/// world is drawn clockwise.
bool mirrors(const CameraView& view);

/// What every shader that draws volumes knows of a light in a view.
/// @param bounded volumes end behind the farthest visible receiver, else at infinity.
gpu::VolumeConstants volumeConstants(const CameraView& view, const LightView& light, bool bounded);

/// Device bytes of all that in a view of this extent.
VkDeviceSize viewStencilMemory(VkExtent2D extent);

} // namespace gnomon
