#pragma once
// The grid of pages that a light's virtual map is made of, or one face of it.
#include <array>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/scene/light_fit.hpp"

namespace gnomon {

/// A square of a virtual map. Texels of level l are 2^l metres wide, for a light with a position at 1 m along its axis.
/// The grid of a level stands still in the world, or with the light.
struct Page {
    int level = 0;
    int x = 0, y = 0;       ///< Along the light's map, to the right and down.
    std::uint32_t face = 0; ///< Of a point light's cube, as in fitCubeFace().

    /// The page of the next coarser level that holds it.
    Page parent() const { return {level + 1, x >> 1, y >> 1, face}; }
};

/// A page as a number: ordered by level, face, row and column, finest level first.
using PageKey = std::uint64_t;
PageKey keyOf(const Page& page);
Page pageOf(PageKey key);

/// A rectangle in the light's map, along its sides: metres from the frame's origin, or from the axis of a light with a
/// position, or of a face, at 1 m along it.
struct PlaneRect {
    glm::dvec2 low{0.0}, high{0.0};

    PlaneRect meet(const PlaneRect& other) const { return {glm::max(low, other.low), glm::min(high, other.high)}; }
    bool overlaps(const PlaneRect& other) const
    {
        return low.x <= other.high.x && low.y <= other.high.y && other.low.x <= high.x && other.low.y <= high.y;
    }
};

/// Pages from `low` up to and including `high`.
struct PageRect {
    glm::ivec2 low{0}, high{-1};

    int width() const { return high.x - low.x + 1; }
    int height() const { return high.y - low.y + 1; }
};

class PageGrid {
public:
    /// @param whole  of fitLightMap(), the face's
    /// @param texels a side of a page that belong to it alone
    /// @param border texels around these that its neighbours hold as well; beyond the border of a face they show what
    ///               its own projection does, so no filter reads another face
    PageGrid(const LightFit& whole, const LightView& light, const double (&origin)[3], std::uint32_t texels,
             std::uint32_t border, std::uint32_t face = 0);

    double width(int level) const; ///< Of a page.
    /// Depth of a point along the axis of a light with a position, metres: dot(depth(), (p, 1)). Otherwise 1.
    const glm::dvec4& depth() const { return depth_; }
    double nearest() const { return nearest_; } ///< Depth at which casters begin.
    /// @pre the depth is above 0
    glm::dvec2 placeOf(glm::dvec3 point) const;
    /// All in which receivers are looked up. Of a map about a place it ends just short of that: pages may end there.
    const PlaneRect& all() const { return all_; }
    /// The planes that bound it.
    std::array<glm::dvec4, 4> edges() const;
    PlaneRect rectOf(const Aabb& box) const;
    /// A page with its border.
    PlaneRect rectOf(const Page& page) const;
    PageRect pagesIn(const PlaneRect& rect, int level) const;
    Page page(int level, int x, int y) const { return {level, x, y, face_}; }
    /// The corner of a page that has the least coordinates.
    glm::dvec2 cornerOf(const Page& page) const;
    /// What is drawn into a page.
    LightFit fitOf(const Page& page) const;
    /// A map of `side` texels as wide as those of the level, whose first texel is the page's.
    LightFit fitAt(const Page& page, std::uint32_t side) const;

    std::uint32_t face() const { return face_; }
    std::uint32_t texels() const { return texels_; }
    std::uint32_t border() const { return border_; }
    int finestLevel() const;

private:
    LightFit window(const PlaneRect& rect) const;

    LightFit whole_;
    glm::dvec2 half_; ///< Of its sides.
    bool positional_;
    glm::dvec4 sides_[2]; ///< Places, times the depth: right and down. Unit normals.
    glm::dvec4 depth_{0, 0, 0, 1};
    glm::dvec2 zero_{0.0}; ///< Of places, from where pages are counted: the world's origin, or a corner of the map.
    double nearest_ = 0.0;
    PlaneRect all_;
    std::uint32_t texels_, border_, face_;
};

} // namespace gnomon
