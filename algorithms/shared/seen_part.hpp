#pragma once
// What a view sees of a light's map: the part of it that receivers can be looked up in.
#include <array>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"

namespace gnomon {

/// A convex polygon in the plane of a map.
struct MapPolygon {
    static constexpr std::size_t kMost = 48;
    std::array<glm::dvec2, kMost> corners{}; ///< In ring order.
    std::size_t count = 0;

    std::span<const glm::dvec2> points() const { return {corners.data(), count}; }
};

/// The plane of a fit's map: clip x / w and y / w, each times half the map's width along it, so that the plane is no
/// longer along one side than along the other. Metres; spot: at 1 m along the axis.
struct MapPlane {
    glm::dvec4 rows[3]; ///< World to (x, y, w) of the plane.
    glm::dvec2 half;    ///< The map is [-half, half].

    explicit MapPlane(const LightFit& fit);
    /// fitProjected()'s `map`, of a map that starts from this plane.
    glm::dmat3 fromClip(const glm::dmat3& map) const;
};

/// A place that a receiver may be at, and how much a texel's width there counts: metres of a unit of the plane, over
/// the width of a pixel.
struct MapSample {
    glm::dvec2 at;
    double weight;
};

/// All that a view can show of what a map covers. It depends on view and light without jumps.
struct SeenPart {
    MapPolygon hull;      ///< Every receiver in view that a caster may shade is in it; no corners: there is none.
    double nearest = 1.0; ///< Linear depth of what is seen of the casters' bounds, metres.
    double farthest = 1.0;
    glm::dvec2 away{0.0, 1.0};           ///< The way that the view looks in the map, unit; any where `sine` is 0.
    double sine = 0.0;                   ///< Of the angle between the view's axis and the light's rays, in the middle.
    std::array<MapSample, 64> samples{}; ///< Of 16 rays of the view, along what is seen of the casters' bounds.
    std::size_t sampleCount = 0;
    double metres = 1.0; ///< That a unit of the plane is wide there.
};

/// Linear depth from which receivers are counted where the near plane is nearer, metres: as cascades count slices,
/// since there is seldom anything so near.
inline constexpr double kNearestReceiver = 1.0;
inline double nearestReceiver(const SeenPart& part)
{
    return part.nearest > kNearestReceiver ? part.nearest : kNearestReceiver;
}

/// @param fit the light's plain one, of all casters
SeenPart seenPart(const ShadowTask& task, const LightFit& fit);

/// The mean width of a map's texels where receivers may be, in pixels, up to a factor: what shadows' edges are off by.
/// @param map of the plane, (x, y, 1), to clip x, y and w
double meanTexel(const SeenPart& part, const glm::dmat3& map);

/// The convex hull, up to 1e-9 of its extent; no corners where it has no area. At most MapPolygon::kMost are kept.
MapPolygon convexHull(std::span<glm::dvec2> points);
/// What two convex polygons share, both in the ring order of convexHull().
MapPolygon overlap(const MapPolygon& of, const MapPolygon& with);

} // namespace gnomon
