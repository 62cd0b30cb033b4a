#pragma once
// The trees of one mesh, and how a revision's are made from what earlier ones left. Internal to this folder, as it
// includes Embree's header.
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "runtime/rays/embree.hpp"
#include "runtime/rays/ray_scene.hpp"
#include "runtime/rays/triangle_tree.hpp"

namespace gnomon {

inline const RTCSceneFlags kSceneFlags = RTC_SCENE_FLAG_ROBUST | EmbreeQuery::kSceneFlag;

/// What Embree took on this thread, as its device reports it; trees are built by one thread each.
inline thread_local std::ptrdiff_t embreeBytesHere = 0;

inline void commitHere(RTCScene scene)
{
    buildHere([scene] { rtcCommitScene(scene); });
}

/// Embree's tree of a mesh.
class EmbreeTree {
public:
    EmbreeTree() = default;
    /// @param movable move() may be called: a dynamic scene of Embree's
    EmbreeTree(RTCDevice device, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
               bool movable);
    EmbreeTree(EmbreeTree&& other) noexcept { swap(other); }
    EmbreeTree& operator=(EmbreeTree other) noexcept
    {
        swap(other);
        return *this;
    }
    ~EmbreeTree();

    /// The same triangles elsewhere: boxes are made again, what is in them stays.
    void move(std::span<const glm::vec3> positions);
    bool movable() const noexcept { return geometry_ != nullptr; }
    RTCScene scene() const noexcept { return scene_; }
    std::size_t bytes() const noexcept { return bytes_; }

private:
    void swap(EmbreeTree& other) noexcept;
    RTCScene scene_ = nullptr;
    RTCGeometry geometry_ = nullptr; ///< Null: not movable.
    std::size_t bytes_ = 0;
};

/// Any thread.
class MeshRaysHistory::Impl {
public:
    Impl();
    struct Latest {
        std::shared_ptr<const TriangleTree> tree; ///< Of the revision that was made last; null: there is none.
        std::uint32_t generation = 0;             ///< Counts the times that trees were built from nothing.
    };
    Latest latest() const;
    /// A new generation: what there is of earlier ones is not used again. @return its number
    std::uint32_t startOver();
    /// Takes a revision's tree for the latest, unless its generation is over. @return a movable tree of that generation
    /// that nobody traces any more, or an empty one
    EmbreeTree exchange(const Latest& made);
    /// Keeps a movable tree for exchange(), unless there are enough or its generation is over.
    void giveBack(EmbreeTree tree, std::uint32_t generation);

private:
    mutable std::mutex mutex_;
    Latest latest_;
    std::vector<EmbreeTree> spares_;
};

struct MeshRays::Impl {
    EmbreeTree embree;
    std::shared_ptr<const TriangleTree> tree;
    std::shared_ptr<std::atomic<std::ptrdiff_t>> treeBytes; ///< Of all meshes; may outlive their scene.
    std::shared_ptr<MeshRaysHistory::Impl> history;         ///< Gets `embree` in the end; null: nobody does.
    std::uint32_t generation = 0;
    bool moved = false;
    float longest = 0.0f; ///< effectiveLength() of its triangles, the largest; object space.

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl();
};

/// Null where Embree has no memory.
std::unique_ptr<MeshRays::Impl> makeMeshRays(RTCDevice device, std::span<const glm::vec3> positions,
                                             std::span<const std::uint32_t> indices,
                                             std::shared_ptr<MeshRaysHistory::Impl> history);

} // namespace gnomon
