#pragma once
// The registry's own records of instances and lights, and the arrays that frames see.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/store/placement.hpp"
#include "runtime/store/scene_input.hpp"
#include "runtime/store/scene_registry.hpp"

namespace gnomon {

/// An instance. Guarded by the registry's mutex, but for name and callbacks, which never change.
struct InstanceRecord {
    std::string name;
    std::uint64_t handle = 0;
    GnMesh mesh = VK_NULL_HANDLE;
    GnTransform transform{};
    std::optional<BufferPlacement> placement; ///< In place of `transform`.
    Aabb hostBounds;                          ///< Object space, host-drawn only.
    bool isStatic = false;
    bool destroyed = false;
    bool dirty = false;   ///< In the list of what the next frame has to look at.
    bool casting = false; ///< In the frame's arrays.

    // As the last frame that looked at it saw it.
    Caster caster;
    InstanceTransform rows{};
    const MeshView* seenView = nullptr;
    GnMesh seenMesh = VK_NULL_HANDLE;
    std::uint64_t seenPositions = 0; ///< MeshView::revision, 0: none.

    std::string what() const { return named("instance", name.c_str()); }
    /// Whether it may be another shape, or elsewhere, in every frame, without a word to us.
    bool changesUnseen() const { return placement || (caster.hostDrawn && !isStatic); }
};

/// A light. Touched by the frame's thread only, but the previous frame's workers may still read the other view.
struct LightRecord {
    std::string name;
    GnLight handle = VK_NULL_HANDLE;
    std::uint32_t id = 0;
    std::uint64_t revision = 0;
    LightDescription light;
    bool moved = false; ///< Was static and has moved.
    bool dirty = true;
    std::array<LightView, 2> views;
    std::uint32_t current = 0; ///< The view this frame sees.
    bool published = false;

    std::string what() const { return named("light", name.c_str()); }
    void publish(const std::array<double, 3>& origin);
};

/// The arrays of casters in two copies: a frame in which something changed gets the copy that the frame before did not
/// look at. Only what changed since that copy was current is written.
class CasterArrays {
public:
    /// For publish() with as many casters, which then cannot fail. The current copy stays where it is.
    void makeRoom(std::size_t casterCount);
    /// @param casting all casters in their order; @param changed those with new content; @param structural the set or
    /// the order changed. Neither: the current copy stays.
    void publish(const std::vector<InstanceRecord*>& casting, const std::vector<InstanceRecord*>& changed,
                 bool structural);
    const SceneRegistry::Snapshot& current() const noexcept { return copies_[current_].snapshot; }

private:
    struct Copy {
        std::vector<Caster> casters;
        std::vector<InstanceTransform> transforms;
        std::vector<InstanceRecord*> behind; ///< Changed since this copy was current.
        bool stale = true;                   ///< Has to be written as a whole.
        SceneRegistry::Snapshot snapshot;

        void write(const InstanceRecord& record);
        void writeAll(const std::vector<InstanceRecord*>& casting);
    };
    std::array<Copy, 2> copies_;
    std::uint32_t current_ = 0;
    std::uint64_t revision_ = 0;
};

/// The caster as a frame sees it, but for the array index. @param view null for host-drawn instances.
void updateCaster(InstanceRecord& record, const MeshView* view, const std::array<double, 3>& origin,
                  std::uint64_t revision);

} // namespace gnomon
