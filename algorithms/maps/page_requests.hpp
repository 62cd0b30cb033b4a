#pragma once
// Which pages of a virtual map a view needs: those that casters in sight may show, as finely as pixels ask for.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/maps/page_grid.hpp"
#include "runtime/algorithm.hpp"
#include "shaders/maps/virtual_map.h"

namespace gnomon {

class ViewSolid;

/// The requests of one view, in memory that is kept from frame to frame.
///
/// A view is cut into slices in which the texels that pixels ask for are as wide as those of one level, or wider, but
/// below twice as wide. Receivers are expected in the bounds of casters (of parts of large meshes): the pages that
/// these cover within the view and the slice are asked. Where they are more than there is room for, slices go to the
/// next coarser level, the farthest first, all of them before any goes to a second one. The room that is left then is
/// for finer pages again, of the nearest slices first. The pages of the coarsest level hold all casters and are always
/// asked: what lies where no page was expected is looked up there.
///
/// The faces of a point light are grids of their own. They share the slices, with their levels, and the room.
class PageRequests {
public:
    struct Wanted {
        std::uint32_t capacity = 4; ///< Most pages, at least 4; of a point light 6.
        double density = 1.0;       ///< Texels to a pixel, along its sides.
    };
    /// @param casters bounds of all
    /// @param grids   one, or those of the point light's faces that receivers in view may lie in; at least one
    void ask(const ShadowTask& task, const Aabb& casters, std::span<const PageGrid> grids, const Wanted& wanted);

    std::span<const PageKey> pages() const { return pages_; }               ///< In their order.
    int firstLevel() const { return first_; }                               ///< That pixels of the first slice ask for.
    std::uint32_t slices() const { return used_; }                          ///< At least 1.
    int levelOf(std::uint32_t slice) const { return slices_[slice].level; } ///< That it is given.
    int coarsest() const { return coarsest_; }
    std::uint32_t withoutRoom() const { return withoutRoom_; } ///< Pages that were asked and are not in pages().

private:
    /// Bounds of what may be seen.
    struct Box {
        Aabb bounds;
        double nearest;           ///< Distance along the view at which it is seen first.
        double narrowest, widest; ///< Pixels there, in the units of the grid.
        const PageGrid* grid;
    };
    /// What is asked within a slice, at the level that it asks for.
    struct Slice {
        int level = 0;
        double narrowest, widest;                        ///< Pixels in it.
        std::array<PlaneRect, gpu::MAX_PAGE_FACES> seen; ///< What the view sees in it of the casters, by face.
        glm::ivec2 corner{0};                            ///< Page of bit 0 of row 0, of the face at hand.
        std::array<std::uint64_t, 64> rows{};
        std::vector<PageKey> pages;
        std::vector<PageKey> finer; ///< Those before it went to a coarser level last.

        std::array<glm::dvec4, 2> ends(const ViewSolid& view, const PageGrid& grid) const; ///< Planes of its own.
    };

    void collectBoxes(const ShadowTask& task, const ViewSolid& view, const PageGrid& grid);
    void addBox(const Aabb& bounds, const CameraView& camera, const ViewSolid& view, const PageGrid& grid);
    void cutSlices(const ViewSolid& view, const Aabb& casters, std::span<const PageGrid> grids);
    void raiseSlices(std::span<const PageGrid> grids);
    void markFace(const ViewSolid& view, const PageGrid& grid);
    void mark(const Box& box, const ViewSolid& view);
    void askCoarsest(std::span<const PageGrid> grids, std::uint32_t most);
    std::span<Slice> used() { return {slices_.data(), used_}; }
    void coarsen(Slice& slice) const;
    std::size_t askedAt(int level);
    void addTo(std::vector<PageKey>& pages);
    void makeRoom(std::uint32_t capacity);

    std::vector<Box> boxes_;
    std::array<Slice, gpu::MAX_PAGE_LEVELS> slices_; ///< Nearest first.
    std::uint32_t used_ = 1;
    std::vector<PageKey> pages_, merged_, wanted_;
    int first_ = 0, coarsest_ = 0;
    std::uint32_t withoutRoom_ = 0;
};

} // namespace gnomon
