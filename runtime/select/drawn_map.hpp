#pragma once
// How long a light's map may be looked up after it was drawn, although the light or casters move: as long as its
// shadows are off by a texel at most. It is looked up with the light's pose that it was drawn with.
#include <cstdint>
#include <vector>

#include "runtime/base/arena.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// A light, and its casters, as a map shows them.
struct MapPose {
    const LightView* light = nullptr;
    const LightCasters* casters = nullptr;
};

/// What a map's drawing depends on besides the pose.
struct MapKey {
    std::uint32_t method = UINT32_MAX;
    double side = 0.0;  ///< Texels.
    double width = 0.0; ///< mapWidth(), metres.

    bool sameMap(const MapKey& other) const { return method == other.method && side == other.side; }
};

/// The newest drawing of a light's map.
class DrawnMap {
public:
    static constexpr double kBoundTexels = 1.0;     ///< By which shadows may be off.
    static constexpr std::uint32_t kMostFrames = 8; ///< From one drawing to the next, of what moves.

    /// The map for this frame: drawn again, or as it is. Lights whose turn comes in the same frames are spread by their
    /// numbers.
    /// @param now     of this frame; memory from the arena for what comes back
    /// @return what the map is to be drawn, or looked up, with
    MapPose next(std::uint64_t frame, const MapKey& key, const MapPose& now, FrameArena& arena);
    /// The next frame draws: a camera cut, another origin, or a frame without this map.
    void lose() { drawnAt_ = 0; }

    std::uint32_t age() const { return age_; } ///< Frames since it was drawn, of the frame that next() was asked for.
    std::uint32_t every() const { return every_; } ///< Frames from one drawing to the next; 0: nothing moves.

    /// Texels by which shadows are off if the map is not drawn again; infinite where that cannot be told, or casters
    /// came or went.
    double texelsOff(const MapKey& key, const MapPose& now) const;

private:
    /// A moving caster as it was drawn.
    struct Placed {
        std::uint32_t id;
        glm::mat3 basis;
        glm::vec3 translation;
        Aabb bounds;
        std::uint64_t revision, meshRevision;
    };
    void draw(std::uint64_t frame, const MapKey& key, const MapPose& now);
    MapPose asDrawn(const MapPose& now, FrameArena& arena) const;

    std::uint64_t drawnAt_ = 0; ///< 0: there is none.
    std::uint32_t age_ = 0, every_ = 1;
    MapKey key_;
    LightView light_;
    std::uint64_t staticStamp_ = 0, dynamicStamp_ = 0;
    std::vector<Placed> moving_;
};

} // namespace gnomon
