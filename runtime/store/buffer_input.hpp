#pragma once
// Meshes and transforms in the host's buffers as the host describes them, checked. No state; every error names the
// value at fault.
#include "runtime/store/placement.hpp"
#include "runtime/store/scene_input.hpp"

namespace gnomon {

/// How such a mesh lies there, and what it is.
struct BufferMeshLayout {
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t stride = 0; ///< Bytes from position to position.
    std::uint32_t positionCount = 0;
    std::uint32_t indexCount = 0; ///< Corners of triangles, whether there are indices or not.
    std::uint32_t indexBytes = 0; ///< 2, 4, or 0: there are none.
    std::int32_t vertexOffset = 0;
    float scale[3]{}, bias[3]{};
    bool turned = false; ///< MeshView::turned
    bool closed = false, noCpuCopy = false;
};

struct BufferMeshInput {
    std::string name;
    BufferMeshLayout layout;
    Aabb bounds;
    VkDescriptorBufferInfo positions{}, indices{}; ///< What is read, and no more.
};

Result<BufferMeshInput> readMeshInBuffers(const GnMeshCreateInfo& info, const MeshLimits& limits);
/// All positions of such a mesh out of a part of a buffer, which may be a pool larger than what the device binds.
Result<VkDescriptorBufferInfo> readPositionRange(Subject what, const BufferMeshLayout& layout,
                                                 const VkDescriptorBufferInfo& positions, const MeshLimits& limits);

/// Of so many instances, not 0. Bounds are checked one by one.
Result<TransformArray> readTransformArray(Subject what, const GnTransformBuffer& transforms, std::uint32_t count,
                                          const MeshLimits& limits);
/// @pre readTransformArray()
Result<Aabb> readPlacedBounds(Subject what, const GnTransformBuffer& transforms, std::uint32_t element);

} // namespace gnomon
