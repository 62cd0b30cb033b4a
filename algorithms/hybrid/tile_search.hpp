#pragma once
// One tile of receivers against the casters of a light: what shafts prove, what shadow volumes of single triangles
// prove, and what only rays can tell. Smaller tiles start from what their parents could not rule out.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/shaft.hpp"
#include "runtime/base/arena.hpp"

namespace gnomon {

/// The casters of a light in this frame; the same for all tiles.
struct ShaftScene {
    ShaftLight light;
    const simd::Kernels* kernels = nullptr;
    std::span<const ShaftCaster> casters;
    std::span<const TriangleTree::Node> boxes; ///< World bounds of the casters, four to a node; child: the caster.
    glm::vec3 row{1.0f, 0.0f, 0.0f};           ///< Direction of pixel rows.
    CasterReach largest;                       ///< Of all casters, part by part.

    ShaftScene(const simd::Kernels& kernels, const LightView& light, std::span<const Caster* const> all,
               glm::vec3 rowDirection, FrameArena& arena);
};

/// What becomes of some of a tile's blocks, and what they hold where that is read only when somebody asks.
class TileAnswers {
public:
    /// The hull of a square of blocks where it is known without looking at them.
    virtual bool knownHull(std::uint32_t /*firstBlock*/, std::uint32_t /*count*/, Hull& /*hull*/) { return false; }
    virtual void wanted(std::uint32_t /*firstBlock*/, std::uint32_t /*count*/) {} ///< Before blocks are looked at.
    virtual void dark(std::uint32_t firstBlock, std::uint32_t count) = 0;         ///< Every pixel that asks.
    /// What is known of one block's lanes; unsure ones want a ray.
    virtual void lanes(std::uint32_t block, simd::LaneStates states) = 0;

protected:
    ~TileAnswers() = default;
};

/// Memory to search tiles in; one a thread.
class TileSearch {
public:
    TileSearch(const ShaftScene& scene, FrameArena& arena);

    /// Searches for a tile of `count` blocks in Z order, count a power of four. Pixels that ask and of which nothing is
    /// reported are lit.
    void run(std::span<const simd::Block> blocks, TileAnswers& answers);

private:
    /// Children of a tree's node that may touch a shaft.
    struct Item {
        std::uint32_t caster, node, mask;
    };
    struct Tile {
        std::uint32_t first, count; ///< Blocks.
    };

    using VolumeList = std::span<const simd::VolumeBits>;
    enum class Found : std::uint8_t { volumes, covered, tooMany };

    /// @param rays set to how many the tile asks for, where it has a hull
    bool hullAround(Tile tile, Hull& hull, std::size_t& rays) const;
    void search(Tile tile, std::span<const Item> items);
    void traceAll(Tile tile);

    std::span<const Item> roots(const Shaft& shaft);
    std::span<const Item> narrowed(std::span<const Item> items, const Shaft& shaft, bool& leaves);
    template <bool Across>
    bool walk(const ShaftCaster& caster, const MeshShaft& shaft, Item item, std::size_t limit);
    std::size_t trianglesIn(std::span<const Item> leaves) const;
    template <typename Take>
    void inSixteens(std::span<const Item> items, const Hull& hull, Take take) const;
    bool hiddenByOne(std::span<const Item> items, const Hull& hull, const Shaft& shaft);
    Found volumesOf(std::span<const Item> items, const Hull& hull);
    bool push(const Item& item);

    void decide(Tile tile, std::size_t rays, const Hull& hull, std::span<const Item> items, bool leaves);
    void searchVolumes(Tile tile, VolumeList above);
    simd::FrameBounds boundsOf(Tile part);

    const ShaftScene& scene_;
    std::span<const simd::Block> blocks_;
    TileAnswers* answers_ = nullptr;
    std::span<Item> items_; ///< A stack: lists of the tiles from the root down to the one at work.
    std::size_t itemCount_ = 0;
    bool overflow_ = false;

    // Of the one tile that has volumes.
    simd::LightFrame frame_{};
    std::span<simd::ShadowVolumes> volumes_;
    std::span<simd::VolumeBits> lists_; ///< A stack as items_.
    std::size_t listCount_ = 0;
    std::span<simd::FrameBounds> bounds_; ///< Of blocks, those whose bit says so.
    std::uint64_t bounded_[4]{};
};

} // namespace gnomon
