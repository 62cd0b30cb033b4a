#pragma once
// What the host registered: meshes, instances, lights; and the snapshot of it that one frame works on.
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/base/arena.hpp"
#include "runtime/base/jobs.hpp"
#include "runtime/base/messages.hpp"
#include "runtime/rays/ray_scene.hpp"
#include "runtime/scene/scene_view.hpp"
#include "runtime/vk/memory.hpp"

namespace gnomon {

class DescriptorRing;
class PipelineStore;

/// The table of transforms the caster vertex shader reads: world = basis * object + translation, as 3 rows of vec4
/// (basis row, translation component).
struct InstanceTransform {
    float rows[12];
};

/// Owns geometry and lights. Mesh and instance calls come from any thread; everything else from the frame's thread.
class SceneRegistry {
public:
    SceneRegistry(const DeviceTable& vk, DeviceMemory& memory, JobSystem& jobs, RayScene* rays,
                  const Messages& messages, bool background);
    ~SceneRegistry();
    SceneRegistry(const SceneRegistry&) = delete;
    SceneRegistry& operator=(const SceneRegistry&) = delete;

    Result<GnMesh> createMesh(const GnMeshCreateInfo& info);
    Result<void> updateMeshPositions(GnMesh mesh, const float* positions, std::uint32_t count, std::uint32_t stride);
    /// @param lower, upper of three numbers; null, both of them: as before
    Result<void> updateMeshFromBuffer(GnMesh mesh, const VkDescriptorBufferInfo& positions, const float* lower,
                                      const float* upper);
    void destroyMesh(GnMesh mesh);
    /// Before the first mesh or transforms in buffers. @param owner of the pipelines that read them; no frame warms
    /// these up
    void readBuffersBy(PipelineStore& pipelines, std::uint32_t owner);

    Result<GnInstance> createInstance(const GnInstanceCreateInfo& info);
    /// One for each transform, or none. @param instances as many
    Result<void> createInstances(const GnInstanceCreateInfo& info, std::span<const GnTransform> transforms,
                                 GnInstance* instances);
    /// Of transforms in info.pTransformBuffer, which is not null.
    Result<void> createPlacedInstances(const GnInstanceCreateInfo& info, std::uint32_t count, GnInstance* instances);
    /// All or none.
    Result<void> updatePlacedInstances(std::span<const GnInstance> instances, const GnTransformBuffer& transforms);
    Result<void> setInstanceTransform(GnInstance instance, const GnTransform& transform);
    /// All or none. @param transforms as many as instances
    Result<void> setInstanceTransforms(std::span<const GnInstance> instances, std::span<const GnTransform> transforms);
    Result<void> setInstanceBounds(GnInstance instance, const float (&lower)[3], const float (&upper)[3]);
    Result<void> setInstanceCasterMask(GnInstance instance, std::uint32_t mask); ///< 0: all bits.
    Result<void> setInstanceMesh(GnInstance instance, GnMesh mesh);
    void destroyInstance(GnInstance instance);

    Result<GnLight> createLight(const GnLightInfo& info);
    Result<void> updateLight(GnLight light, const GnLightInfo& info);
    void destroyLight(GnLight light);
    bool validLight(GnLight light) const;
    /// What never changes about a light while it lives; nothing if the handle is wrong.
    struct LightInfo {
        std::uint32_t id;
        GnLightType type;
        std::string_view name;
    };
    std::optional<LightInfo> lightInfo(GnLight light) const;

    /// The frame's casters and lights relative to `origin`. The arrays stay as they are until the second next begin();
    /// the meshes, names and buffers they point to until retire() passes the frame. Allocates nothing when nothing was
    /// added. A frame in which nothing changed gets the arrays of the one before.
    /// @param frame number of the frame; what is dropped is kept alive until retire(>= frame).
    struct Snapshot {
        std::span<const Caster> casters;               ///< All instances that can cast (mesh alive or host-drawn).
        std::span<const InstanceTransform> transforms; ///< One per caster, by Caster::index.
        std::uint64_t revision = 0;                    ///< Changes when any caster does.
    };
    const Snapshot& begin(std::uint64_t frame, const std::array<double, 3>& origin);

    /// A light as this frame sees it; null if destroyed, or created after begin().
    const LightView* light(GnLight light) const;
    /// The casters in a light's reach, with stamps that change exactly when the set or a member does. Once per light
    /// and frame, memory from the arena.
    LightCasters castersOf(const LightView& light, FrameArena& arena) const;

    /// Uploads of meshes created or rewritten since the last frame: device-local copies are made by the caller's
    /// command buffer. On devices where buffers are written in place there is nothing to record.
    bool uploadsPending() const;
    void recordUploads(VkCommandBuffer cmd, std::uint64_t frame);
    /// The same of meshes and transforms in the host's buffers, as of the newest begin(), and copies of these meshes
    /// for the CPU. After the uploads: what the GPU wrote last counts.
    /// @param table of the frame's transforms
    bool conversionsPending() const;
    Result<void> recordConversions(VkCommandBuffer cmd, std::uint64_t frame, DescriptorRing& descriptors,
                                   VkBuffer table);
    /// The command buffer recorded for `frame` will not be submitted: all of that is to be recorded again.
    void dropUploads(std::uint64_t frame);

    /// Frees what was replaced or destroyed in frames up to `completedFrame`.
    void retire(std::uint64_t completedFrame);
    /// Blocks until topology and trees of all meshes are built.
    void finishBackground();

private:
    Result<GnMesh> createMeshInBuffers(const GnMeshCreateInfo& info);
    void finishCopies();
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace gnomon
