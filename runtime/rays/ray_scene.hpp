#pragma once
// Shadow rays against the frame's casters (Embree, two-level, robust). The files of this folder are the
// only ones that include Embree's headers.
#include <cstdint>
#include <memory>
#include <span>

#include "runtime/base/jobs.hpp"
#include "runtime/rays/ray_packet.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

class TriangleTree;

/// Whether rays meet a caster: it has a mesh with a tree, and a basis with an inverse (as a volume it is empty else)
/// that takes nothing within 10^9 m of the frame's origin farther away than the ray tracer reaches, 10^18 m.
bool castsRays(const Caster& caster);
/// Says which hits of a caster count; null: all.
inline PFN_gnOpacity opacityOf(const Caster& caster)
{
    return caster.alphaTested ? caster.opacity : nullptr;
}

/// One shadow ray: from the (already offset) receiver to just before the light.
struct ShadowRay {
    glm::vec3 origin;    ///< World, relative to the frame's origin; the offset of definitions is applied.
    float tfar;          ///< Multiples of `direction`; the light minus the offset, or infinity.
    glm::vec3 direction; ///< Need not be unit length.
};

/// What revisions of a mesh hand on for as long as its triangles stay the same: a tree that nobody traces any more is
/// moved to the next positions, which takes a twentieth of the time of building one (bench_rays). Trees that have worn,
/// which triangles that part do to them, are built again.
class MeshRaysHistory {
public:
    class Impl;
    MeshRaysHistory();
    ~MeshRaysHistory();
    MeshRaysHistory(const MeshRaysHistory&) = delete;
    MeshRaysHistory& operator=(const MeshRaysHistory&) = delete;

private:
    friend class RayScene;
    std::shared_ptr<Impl> impl_;
};

/// The trees of one mesh: Embree's for rays, and one that may be walked; built by a worker.
class MeshRays {
public:
    struct Impl;
    ~MeshRays();
    MeshRays(const MeshRays&) = delete;
    MeshRays& operator=(const MeshRays&) = delete;
    std::size_t memoryBytes() const noexcept; ///< Of both.
    bool moved() const noexcept;              ///< Embree's is one that was handed on, not built.
    /// Null where it could not be made.
    const std::shared_ptr<const TriangleTree>& tree() const noexcept;

private:
    friend class RayScene;
    explicit MeshRays(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The casters of one frame as something to ask for occlusion.
class RayScene {
public:
    RayScene();
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    /// Builds a mesh's trees; any thread. The arrays must outlive the result (they are shared, not copied; positions
    /// are read as 16-byte loads, so the array must be readable 4 bytes past its end).
    /// @param history what builds with the same `indices`, the array itself, hand on; outlives the array's use; or
    /// null.
    std::unique_ptr<MeshRays> build(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                    MeshRaysHistory* history = nullptr);

    /// Brings the top level to this frame's casters (those with mesh->rays; others are left out). Only what changed
    /// since the last call is touched; nothing changed costs nothing. One thread, before any trace of the frame.
    /// @return false where memory was short: some casters, or all, block nothing until a later call has had room
    bool update(std::span<const Caster> casters);

    /// Sets occluded[i] to 1 if anything with a matching caster mask blocks ray i, else 0. Several threads may call it
    /// at once. Ray counts need not be multiples of the packet width. Nothing blocks rays that are no numbers or start
    /// beyond the ray tracer's reach. Long and thin triangles do not block rays that start on them (long_edges.hpp).
    /// @param rays any sixteen that come one after the other, such as 4x4 pixels, are faster the closer they lie
    void occluded(std::span<const ShadowRay> rays, std::uint32_t lightMask, std::span<std::uint8_t> occluded) const;

    /// The same for rays that lie in packets. What blocked a ray is in its tfar.
    void occluded(std::span<RayPacket> packets, std::uint32_t lightMask) const;

    std::size_t memoryBytes() const noexcept;
    /// Time inside occluded() so far, that of every thread added up.
    std::uint64_t queryNanoseconds() const noexcept;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace gnomon
