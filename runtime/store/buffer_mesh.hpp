#pragma once
// Meshes in the host's buffers: the GPU's copy of them, and the passes that read these buffers.
#include <mutex>

#include "runtime/store/buffer_input.hpp"
#include "runtime/store/mesh_store.hpp"
#include "runtime/store/placement.hpp"
#include "runtime/vk/descriptor_ring.hpp"
#include "runtime/vk/pipeline_store.hpp"

namespace gnomon {

/// Edges and faces of a mesh in buffers, whatever its pose: of all triangles, with an area in the pose that was copied
/// or without. Vertices are one where they were so in every pose that was copied. The GPU watches whether they stay so.
struct MeshConnectivity {
    std::shared_ptr<const Topology> topology;
    std::vector<std::uint32_t> welded; ///< weldVertices()
    OwnedBuffer watched; ///< Mapped: the first vertex that has come off the one it was welded to (UINT32_MAX: none),
                         ///< then `welded`.
    std::uint64_t revision = 0; ///< MeshView::connectivityRevision

    std::uint32_t firstApart() const noexcept;
};

/// What all revisions of such a mesh share. The GPU rewrites its copy in place, between two frames that draw it: all of
/// them are on one queue. A copy, since every reader wants 12-byte positions and 32-bit indices that are in range, and
/// since the host has its buffers back after one frame.
struct BufferMesh {
    std::shared_ptr<MeshIdentity> identity;
    BufferMeshLayout layout;
    std::uint64_t faces = 0; ///< MeshView::faces
    OwnedBuffer vertices, indices;
    OwnedBuffer findings; ///< Mapped: MeshFindings, written by the GPU.

    // Guarded by the registry's mutex.
    std::shared_ptr<MeshFaces> copiedFaces; ///< Of the newest copy for the CPU; never written while one is made.
    std::shared_ptr<const MeshConnectivity> connectivity; ///< Likewise.
    Aabb bounds;                                          ///< The newest that the host gave.
    bool destroyed = false;                               ///< The host's buffers may be gone.
    bool copying = false;                                 ///< For the CPU.
    bool tried = false;                                   ///< A copy has been made, or could not be.
    bool cameApart = false;                               ///< Vertices of `connectivity`; a copy will tell which.
    bool mendFailed = false;                              ///< The newest copy that should have told did not.
    std::uint32_t rests = 0;                              ///< Frames without a rewrite while a copy is wanted.
    bool told = false;                                    ///< Of what was wrong.
};

/// As mesh_positions.comp and mesh_indices.comp have it.
struct MeshFindings {
    std::uint32_t firstWrongVertex, firstWrongIndex; ///< UINT32_MAX: none.
};

/// The compute passes that read the host's buffers.
class MeshConverter {
public:
    /// @param owner of the pipelines, in the store
    MeshConverter(const DeviceTable& vk, PipelineStore& pipelines, std::uint32_t owner);

    /// Makes the pipelines, once: some milliseconds. Any thread.
    Result<void> prepare();
    /// Barriers are the caller's: host's writes before compute reads, and compute writes before what follows.
    /// @param connectivity that is watched; null: none
    Result<void> positions(VkCommandBuffer cmd, DescriptorRing& descriptors, const BufferMesh& mesh,
                           const MeshConnectivity* connectivity, const VkDescriptorBufferInfo& from) const;
    Result<void> indices(VkCommandBuffer cmd, DescriptorRing& descriptors, const BufferMesh& mesh,
                         const VkDescriptorBufferInfo& from) const;
    /// @param table of the frame's transforms
    Result<void> transforms(VkCommandBuffer cmd, DescriptorRing& descriptors, const PlacementRun& run,
                            VkBuffer table) const;

private:
    struct Job {
        PipelineId pipeline;
        VkDescriptorBufferInfo from; ///< Aligned as the device asks.
        VkDescriptorBufferInfo to;   ///< Likewise.
        VkBuffer findings;
        VkBuffer watched; ///< Null: none.
        std::uint32_t count;
        const void* push;
        std::uint32_t pushBytes;
    };
    Result<void> dispatch(VkCommandBuffer cmd, DescriptorRing& descriptors, const Job& job) const;
    VkDescriptorBufferInfo aligned(const VkDescriptorBufferInfo& from) const;

    const DeviceTable& vk_;
    PipelineStore& pipelines_;
    std::uint32_t owner_;
    PipelineId positions_, indices_, transforms_;
    std::mutex mutex_;
};

} // namespace gnomon
