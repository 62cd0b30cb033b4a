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
class PageRequests {
public:
    struct Wanted {
        std::uint32_t capacity = 4; ///< Most pages, at least 4.
        double density = 1.0;       ///< Texels to a pixel, along its sides.
    };
    /// @param casters bounds of all
    void ask(const ShadowTask& task, const Aabb& casters, const PageGrid& grid, const Wanted& wanted);

    std::span<const PageKey> pages() const { return pages_; }               ///< In their order.
    int firstLevel() const { return first_; }                               ///< That pixels of the first slice ask for.
    std::uint32_t slices() const { return used_; }                          ///< At least 1.
    int levelOf(std::uint32_t slice) const { return slices_[slice].level; } ///< That it is given.
    int coarsest() const { return coarsest_; }

private:
    /// Bounds of what may be seen.
    struct Box {
        Aabb bounds;
        double nearest;           ///< Distance along the view at which it is seen first.
        double narrowest, widest; ///< Pixels there, in the units of the grid.
    };
    /// What is asked within a slice, at the level that it asks for.
    struct Slice {
        int level = 0;
        glm::dvec4 ends[2]{};     ///< Planes between which it lies.
        double narrowest, widest; ///< Pixels in it.
        PlaneRect seen;           ///< What the view sees in it of the casters.
        glm::ivec2 corner{0};     ///< Page of bit 0 of row 0.
        std::array<std::uint64_t, 64> rows{};
        std::vector<PageKey> pages;
        std::vector<PageKey> finer; ///< Those before it went to a coarser level last.
    };

    void collectBoxes(const ShadowTask& task, const ViewSolid& view, const PageGrid& grid);
    void addBox(const Aabb& bounds, const CameraView& camera, const ViewSolid& view, const PageGrid& grid);
    void cutSlices(const ViewSolid& view, const Aabb& casters, const PageGrid& grid);
    void raiseSlices(const PageGrid& grid);
    void mark(const Box& box, const ViewSolid& view, const PageGrid& grid);
    void askCoarsest(const PageGrid& grid, std::uint32_t capacity);
    std::span<Slice> used() { return {slices_.data(), used_}; }
    void coarsen(Slice& slice) const;
    std::size_t askedAt(int level);
    void makeRoom(std::uint32_t capacity);

    std::vector<Box> boxes_;
    std::array<Slice, gpu::MAX_PAGE_LEVELS> slices_; ///< Nearest first.
    std::uint32_t used_ = 1;
    std::vector<PageKey> pages_, merged_;
    int first_ = 0, coarsest_ = 0;
};

} // namespace gnomon
