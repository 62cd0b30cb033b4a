#pragma once
// The part of space that a view sees, cut by distance and by boxes.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// A convex polygon. A square that is clipped by the planes of a solid keeps within its room.
class Polygon {
public:
    /// A square on a plane, about the point of it that is nearest to `centre`, so wide that it covers all of the plane
    /// within `radius` of there. @param plane its normal is unit
    Polygon(const glm::dvec4& plane, glm::dvec3 centre, double radius);

    /// Keeps where dot(plane, (p, 1)) >= 0.
    void clip(const glm::dvec4& plane);
    std::span<const glm::dvec3> corners() const { return {corners_.data(), count_}; }

private:
    static constexpr std::size_t kRoom = 24; // each plane adds a corner at most
    std::array<glm::dvec3, kRoom> corners_;
    std::size_t count_ = 4;
};

/// What a view sees, without near and far end. What planes measure of a point p is dot(plane, (p, 1)).
class ViewSolid {
public:
    /// @param density texels to a pixel, along its sides
    ViewSolid(const CameraView& view, double density);

    double nearest() const { return nearest_; }              ///< Of the near plane, metres along the view.
    const glm::dvec4& distance() const { return distance_; } ///< Metres along the view.
    const glm::dvec4& pixel() const { return pixel_; }       ///< The width of a pixel at a point, metres.

    /// Calls visit(polygon) with the surface of what is seen of a box before some planes, which has all corners of
    /// that. Nothing is called where nothing is seen.
    /// @param ends at most 8; they need not be unit
    template <typename Visit>
    void forSurface(const Aabb& box, std::span<const glm::dvec4> ends, const Visit& visit) const
    {
        const glm::dvec3 centre(box.center());
        const double radius = glm::length(glm::dvec3(box.halfExtent()));
        std::array<glm::dvec4, 18> room;
        const std::span<const glm::dvec4> planes = planesOf(box, ends, room);
        for (const glm::dvec4& plane : planes) {
            if (!(std::abs(glm::dot(plane, glm::dvec4(centre, 1.0))) <= radius)) continue; // it does not cut the box
            Polygon face(plane, centre, radius);
            for (const glm::dvec4& other : planes)
                if (&other != &plane) face.clip(other);
            if (!face.corners().empty()) visit(face);
        }
    }

private:
    /// Inward, unit: six of a box, four sides, and the ends.
    std::span<const glm::dvec4> planesOf(const Aabb& box, std::span<const glm::dvec4> ends,
                                         std::array<glm::dvec4, 18>& room) const;

    glm::dvec4 distance_, pixel_;
    std::array<glm::dvec4, 4> sides_;
    double nearest_ = 0.0;
};

/// The least and the greatest that a plane measures of a box.
struct Measured {
    double least, greatest;
};
inline Measured measured(const glm::dvec4& plane, const Aabb& box)
{
    const double middle = glm::dot(plane, glm::dvec4(glm::dvec3(box.center()), 1.0));
    const double reach = glm::dot(glm::abs(glm::dvec3(plane)), glm::dvec3(box.halfExtent()));
    return {middle - reach, middle + reach};
}

} // namespace gnomon
