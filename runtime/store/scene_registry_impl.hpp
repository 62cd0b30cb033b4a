#pragma once
// State of the SceneRegistry. Its functions are in scene_registry.cpp (instances, lights), scene_meshes.cpp (meshes,
// uploads, what waits for the GPU), scene_buffers.cpp (meshes in the host's buffers), scene_placements.cpp (transforms
// there) and scene_frame.cpp (what one frame sees).
#include <algorithm>
#include <optional>

#include "runtime/base/make_room.hpp"
#include "runtime/base/slot_map.hpp"
#include "runtime/store/buffer_mesh.hpp"
#include "runtime/store/scene_records.hpp"
#include "runtime/store/scene_registry.hpp"

namespace gnomon {

using RevisionPtr = std::shared_ptr<MeshRevision>;
using InstancePtr = std::shared_ptr<InstanceRecord>;
using LightPtr = std::shared_ptr<LightRecord>;

inline Error tooMany(const char* kind)
{
    return {GN_ERROR_TOO_MANY, "TooManyHandles", std::string("more than 16777216 objects of kind ") + kind};
}

/// An instance as the host describes it, not yet in the registry.
Result<InstancePtr> instanceRecordOf(const GnInstanceCreateInfo& info);
/// The error with the element of an array at fault.
Error atElement(std::size_t index, const char* array, Error error);

/// The second half of a barrier: every read of vertices and indices, as such, as storage buffers or by builds.
inline VkMemoryBarrier2 beforeMeshReads(const DeviceTable& vk)
{
    VkMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT |
                           VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.dstAccessMask =
        VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
    if (vk.rayQuery()) {
        barrier.dstStageMask |= VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
        barrier.dstAccessMask |= VK_ACCESS_2_SHADER_READ_BIT;
    }
    return barrier;
}

inline void orderMemory(const DeviceTable& vk, VkCommandBuffer cmd, const VkMemoryBarrier2& barrier)
{
    VkDependencyInfo dependency{};
    dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vk.vkCmdPipelineBarrier2(cmd, &dependency);
}

struct SceneRegistry::Impl {
    Impl(const DeviceTable& table, DeviceMemory& memory, JobSystem& jobSystem, RayScene* rays, const Messages& receiver,
         bool background)
        : vk(table), jobs(jobSystem), messages(receiver), builder(table, memory, rays, receiver, background)
    {
    }
    ~Impl();

    // What waits for the GPU.
    struct Grave {
        std::uint64_t frame; ///< The last one that may use it.
        std::shared_ptr<const void> object;
    };
    struct RecordedUpload {
        std::uint64_t frame;
        MeshUpload upload;
        std::shared_ptr<const void> target;
    };

    /// What the GPU has to read out of the host's buffers.
    struct Conversion {
        RevisionPtr revision;
        VkDescriptorBufferInfo positions{};
        std::optional<VkDescriptorBufferInfo> indices; ///< The first time.
    };
    struct RecordedConversion {
        std::uint64_t frame;
        Conversion conversion;
    };
    /// A revision that the GPU alone has, on its way to the CPU and through a worker.
    struct MeshCopy {
        RevisionPtr of;
        std::uint64_t mesh = 0; ///< Handle.
        OwnedBuffer content;
        std::uint64_t frame = 0; ///< Which records it; 0: none yet.
        bool submitted = false;  ///< The job.
        bool connects = false;   ///< Connectivity is made, too.
        const Impl* registry = nullptr;
        JobSystem::Job job;
        RevisionPtr made;                                     ///< By the job; null where it failed.
        std::shared_ptr<const MeshConnectivity> connectivity; ///< Likewise.
        std::vector<MeshUpload> uploads;
    };
    using CopyPtr = std::shared_ptr<MeshCopy>;

    // Mutex held.
    static void request(Conversion conversion, std::vector<Conversion>& list);
    void takeConversions();
    bool beginCopy(std::uint64_t mesh);
    void wantCopy(std::uint64_t mesh);
    void recordCopies(VkCommandBuffer cmd, std::uint64_t frame);
    void dropConversions(std::uint64_t frame);
    void adoptCopies(std::vector<RevisionPtr>& released);
    static void watch(const MeshRevision& converted);
    // Not with the mutex held.
    void retireConversions(std::uint64_t completedFrame);
    void tell(const BufferMesh& mesh) const;
    void makeCopied(MeshCopy& copy) const noexcept;
    void reportWaitingCopies();
    void retirePlacements();

    RevisionPtr* findMesh(GnMesh mesh) noexcept { return meshes.find(bitsOf(mesh)); }
    void adoptBuilt(std::vector<RevisionPtr>& released);
    /// The same once there are many: meshes are created by the thousand.
    void adoptMany(std::vector<RevisionPtr>& released);
    /// Room for what keepSafe() takes in; for what is recorded as well, which dropUploads() may bring back.
    void makeRoomFor(const std::vector<MeshUpload>& made);
    void keepSafe(const RevisionPtr& revision, std::vector<MeshUpload>& made);
    void bury(std::shared_ptr<const void> object) { graves.push_back({lastFrame, std::move(object)}); }
    void release(RevisionPtr revision, std::vector<RevisionPtr>& released);
    /// Not with the mutex held. What no frame has seen goes with its last owner, and so do its uploads.
    void letGo(std::vector<RevisionPtr>& released);
    void mark(InstanceRecord& record);
    /// A static instance that the host has moved. Not with the mutex held.
    void reportMoved(const InstanceRecord& record) const
    {
        messages.warn("StaticInstanceMoved",
                      record.what() + " is static but has moved; it counts as moving from now on");
    }
    Result<void> makeRoomLike(const InstanceRecord& record, std::size_t count);
    std::uint64_t insert(InstancePtr record) noexcept;
    void forgetDestroyed();
    void markChangedMeshes();
    void markRestless();
    void findPlacements();
    void makeRoomForFrame();
    bool refreshMarked();
    bool refresh(InstanceRecord& record);
    void refreshLights(bool shifted);

    void submit(MeshRevision& revision)
    {
        if (!revision.job.done()) jobs.submit(revision.job);
    }

    const DeviceTable& vk;
    JobSystem& jobs;
    const Messages& messages;
    MeshBuilder builder;

    mutable std::mutex mutex; ///< Guards what follows.
    SlotMap<RevisionPtr> meshes;
    SlotMap<InstancePtr> instances;
    std::vector<InstancePtr> order;        ///< By creation; destroyed ones until the next frame.
    std::vector<InstanceRecord*> restless; ///< Those of `order` that the host draws, or the GPU places.
    std::vector<InstanceRecord*> dirty;    ///< To be looked at by the next frame.
    std::size_t destroyed = 0;             ///< In `order`.
    bool castersLeft = false;              ///< One of those was in the frame's arrays.
    bool meshesChanged = false;            ///< Since the last frame.
    std::vector<RevisionPtr> building;     ///< Jobs submitted, or about to be.
    std::size_t adoptAt = 0;               ///< As many of these are many.
    std::vector<MeshUpload> uploads;
    std::vector<RecordedUpload> recorded;
    std::vector<Grave> graves;
    std::uint64_t lastFrame = 0; ///< 0: no frame yet.
    std::unique_ptr<MeshConverter> converter;
    std::vector<Conversion> requested, due; ///< Since begin(), and before.
    std::vector<RecordedConversion> converted;
    std::vector<std::uint64_t> copiesWanted; ///< Handles.
    std::vector<CopyPtr> copies;
    bool copyWaits = false; ///< For memory.
    bool copyWaitReported = false;

    // The frame's thread only.
    SlotMap<LightPtr> lights;
    std::uint32_t lightIds = 0;
    std::uint64_t lightRevisions = 0, casterRevisions = 0;
    std::array<double, 3> origin{};
    std::vector<InstanceRecord*> casting; ///< The frame's casters in order.
    std::vector<InstanceRecord*> changed; ///< Those with new content.
    CasterArrays arrays;
    std::vector<PlacementRun> placements; ///< Of the frame. Guarded by the mutex.
    std::vector<InstancePtr> reports;     ///< Static instances found moved; said when the mutex is free again.
    // Freed when the mutex is free again; kept so that a steady frame allocates nothing.
    std::vector<RevisionPtr> releasedRevisions;
    std::vector<Grave> releasedGraves;
    std::vector<RecordedUpload> releasedUploads;
};

} // namespace gnomon
