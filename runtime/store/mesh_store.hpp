#pragma once
// Meshes as revisions: every rewrite of the positions makes a new one, so that frames in flight keep theirs.
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "runtime/base/jobs.hpp"
#include "runtime/base/messages.hpp"
#include "runtime/rays/ray_scene.hpp"
#include "runtime/scene/topology.hpp"
#include "runtime/store/scene_input.hpp"
#include "runtime/vk/memory.hpp"

namespace gnomon {

/// A buffer that goes back to its memory.
class OwnedBuffer {
public:
    OwnedBuffer() = default;
    OwnedBuffer(DeviceMemory& memory, GpuBuffer buffer) noexcept : memory_(&memory), buffer_(buffer) {}
    OwnedBuffer(OwnedBuffer&& other) noexcept { swap(other); }
    OwnedBuffer& operator=(OwnedBuffer other) noexcept
    {
        swap(other);
        return *this;
    }
    ~OwnedBuffer()
    {
        if (memory_) memory_->destroy(buffer_);
    }

    const GpuBuffer& get() const noexcept { return buffer_; }

private:
    void swap(OwnedBuffer& other) noexcept
    {
        std::swap(memory_, other.memory_);
        std::swap(buffer_, other.buffer_);
    }
    DeviceMemory* memory_ = nullptr;
    GpuBuffer buffer_;
};

/// A copy to a device-local buffer that a command buffer has still to make.
struct MeshUpload {
    OwnedBuffer staging;
    VkBuffer target = VK_NULL_HANDLE;
    VkDeviceSize size = 0;
    std::weak_ptr<const void> owner; ///< Of the target. Expired: nobody needs the copy any more.
};

/// What all revisions of a mesh have in common.
struct MeshIdentity {
    std::string name;
    std::uint32_t id = 0;                                    ///< MeshView::id.
    std::shared_ptr<const std::vector<std::uint32_t>> given; ///< Indices as the host gave them.
    std::uint32_t positionCount = 0;
    bool turned = false;               ///< MeshView::turned; `given` is turned already.
    std::atomic<bool> remarked{false}; ///< That it is open or not manifold has been said.

    std::string what() const { return named("mesh", name.c_str()); }
};

/// Triangles with an area. Shared by revisions for as long as the same triangles have one.
struct MeshFaces {
    std::shared_ptr<const std::vector<std::uint32_t>> indices;
    std::vector<std::uint32_t> givenNumbers; ///< MeshView::givenNumbers. The same indices mean the same numbers.
    OwnedBuffer buffer;
    std::uint64_t id = 0; ///< MeshView::faces.

    /// Connectivity found by an earlier revision; the next one takes it over.
    std::shared_ptr<const Topology> connectivity() const
    {
        const std::lock_guard lock(mutex_);
        return connectivity_;
    }
    void remember(std::shared_ptr<const Topology> topology)
    {
        const std::lock_guard lock(mutex_);
        connectivity_ = std::move(topology);
    }
    MeshRaysHistory rays;

private:
    mutable std::mutex mutex_;
    std::shared_ptr<const Topology> connectivity_;
};

struct BufferMesh; // buffer_mesh.hpp
struct MeshConnectivity;
struct BufferMeshInput;

/// One revision of a mesh and all that is derived from it. What a frame has been shown does not change any more:
/// `bare` is complete from the start, `full` once the job is done.
struct MeshRevision {
    std::shared_ptr<MeshIdentity> identity;
    std::shared_ptr<BufferMesh> inBuffers; ///< Null: of arrays.
    std::shared_ptr<MeshFaces> faces;
    std::vector<glm::vec3> positions; ///< Padded. Empty where the GPU alone has them.
    std::vector<Aabb> chunks;         ///< MeshView::chunks.
    OwnedBuffer vertices;
    std::shared_ptr<const Topology> topology;
    std::shared_ptr<const MeshConnectivity> connectivity; ///< Of a mesh in buffers.
    std::shared_ptr<const MeshRays>
        rays; ///< Reads `positions` and `faces`: declared, and thus destroyed, in this order.
    MeshView bare;
    MeshView full;

    JobSystem::Job job; ///< Must be done before the revision goes.
    const class MeshBuilder* builder = nullptr;
    std::atomic<bool> abandoned{false}; ///< Replaced or destroyed: the job has nothing to do.

    // Guarded by the registry's mutex.
    const MeshView* shown = nullptr; ///< `bare` or `full`: what the next frame sees.
    bool seen = false;               ///< By any frame.
};

/// Makes revisions. Safe from several threads.
class MeshBuilder {
public:
    MeshBuilder(const DeviceTable& vk, DeviceMemory& memory, RayScene* rays, const Messages& messages, bool background);

    /// A new mesh. With background work its job is to be submitted once the revision is in safe keeping; until then it
    /// counts as unfinished.
    Result<std::shared_ptr<MeshRevision>> create(MeshInput input, std::vector<MeshUpload>& uploads) const;
    /// The mesh of `old` with other positions, as many as before, padded.
    Result<std::shared_ptr<MeshRevision>> rewrite(const MeshRevision& old, std::vector<glm::vec3> positions,
                                                  std::vector<MeshUpload>& uploads) const;

    /// A mesh in the host's buffers, which the GPU has still to read.
    Result<std::shared_ptr<MeshRevision>> createInBuffers(BufferMeshInput input) const;
    /// The mesh, whose positions the GPU will read again.
    std::shared_ptr<MeshRevision> rewriteInBuffers(std::shared_ptr<BufferMesh> mesh, const Aabb& bounds) const;
    /// The same revision as a mesh of arrays, derived parts included. One at a time per mesh.
    /// @param content positions, then indices, as in BufferMesh
    Result<std::shared_ptr<MeshRevision>> copied(const MeshRevision& of, const std::byte* content,
                                                 std::vector<MeshUpload>& uploads) const;
    /// Its connectivity, corrected where `of` has one already. After copied(), also where that has failed.
    /// @param made by copied(), or null
    Result<std::shared_ptr<const MeshConnectivity>> connected(const MeshRevision& of, const std::byte* content,
                                                              const MeshRevision* made) const;

    /// For copied(). Mapped.
    Result<OwnedBuffer> readback(VkDeviceSize size, const std::string& name) const;
    /// For what shaders find, mapped: all ones.
    Result<OwnedBuffer> findings(VkDeviceSize size, const std::string& name) const;
    bool inBackground() const noexcept { return background_; }

    MeshLimits limits() const noexcept
    {
        return {vk_.properties.limits.maxStorageBufferRange, vk_.properties.limits.maxDrawIndexedIndexValue};
    }

private:
    Result<std::shared_ptr<MeshRevision>> finish(std::shared_ptr<MeshRevision> revision, bool inBackground,
                                                 std::vector<MeshUpload>& uploads) const;
    Result<OwnedBuffer> upload(const void* data, VkDeviceSize size, VkBufferUsageFlags usage, const std::string& name,
                               std::vector<MeshUpload>& uploads) const;
    void derive(MeshRevision& revision) const noexcept;
    void remarkOn(const MeshRevision& revision) const;

    const DeviceTable& vk_;
    DeviceMemory& memory_;
    RayScene* rays_;
    const Messages& messages_;
    bool background_;
    mutable std::atomic<std::uint32_t> meshes_{0};
    mutable std::atomic<std::uint64_t> revisions_{0}, faces_{0};
};

} // namespace gnomon
