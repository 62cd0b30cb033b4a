// The four planes around what a triangle shadows.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "algorithms/hybrid/shaft.hpp"

namespace gnomon {

namespace {

constexpr double kRoundoff = 0x1p-24;

/// A plane with what the ray tracer may be off by at the receivers.
struct Wall {
    glm::dvec3 normal{0.0};
    double distance = 1e30; ///< Of a wall that is not there: everything is inside.
    double margin = 0.0;
};

/// A wall as the lanes see it: relative to the centre, in single precision, whose errors widen the margin.
void store(const Wall& wall, const Hull& hull, glm::dvec3 centre, int slot, lanes::ShadowPlanes& planes)
{
    const double f = wall.distance + glm::dot(wall.normal, centre);
    // Receivers lie in the hull; five roundings of a sum of products, five of the plane's own numbers.
    const glm::dvec3 reach = hull.largest() + glm::abs(centre);
    const glm::dvec3 extent =
        glm::min(reach, glm::abs(hull.centre - centre) + glm::abs(hull.axis[0]) * hull.half[0] +
                            glm::abs(hull.axis[1]) * hull.half[1] + glm::abs(hull.axis[2]) * hull.half[2]);
    const double sums = 10.0 * kRoundoff * (2.0 * glm::dot(glm::abs(wall.normal), extent));
    planes.x[slot] = static_cast<float>(wall.normal.x);
    planes.y[slot] = static_cast<float>(wall.normal.y);
    planes.z[slot] = static_cast<float>(wall.normal.z);
    planes.f[slot] = static_cast<float>(f);
    planes.margin[slot] = static_cast<float>((wall.margin + sums) * (1.0 + 1e-6));
}

/// A triangle as the light sees it.
struct Seen {
    Wall own; ///< Its own plane: inside is what lies behind it.
    Wall edges[3];
    double height[3];   ///< Of the corner across each edge over its wall.
    double lightHeight; ///< Of the light over the triangle's plane; of directional lights the sine.
};

Seen look(const ShaftLight& light, const glm::dvec3 (&corners)[3], glm::dvec3 rounding)
{
    Seen seen;
    glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    normal /= std::max(glm::length(normal), 1e-300);
    seen.lightHeight =
        light.directional ? glm::dot(normal, light.toLight) : glm::dot(normal, light.position - corners[0]);
    if (seen.lightHeight < 0.0) {
        normal = -normal;
        seen.lightHeight = -seen.lightHeight;
    }
    seen.own = {-normal, glm::dot(normal, corners[0]), glm::dot(glm::abs(normal), rounding)};
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 a = corners[i], b = corners[(i + 1) % 3], third = corners[(i + 2) % 3];
        glm::dvec3 side =
            light.directional ? glm::cross(light.toLight, b - a) : glm::cross(a - light.position, b - light.position);
        side /= std::max(glm::length(side), 1e-300);
        seen.height[i] = glm::dot(side, third - a);
        if (seen.height[i] < 0.0) {
            side = -side;
            seen.height[i] = -seen.height[i];
        }
        seen.edges[i] = {side, -glm::dot(side, light.directional ? a : light.position),
                         glm::dot(glm::abs(side), rounding)};
    }
    return seen;
}

/// How much wider than at the triangle an error of direction is at the hull.
double magnification(const ShaftLight& light, const Hull& hull, const glm::dvec3 (&corners)[3], double lightHeight)
{
    if (light.directional) return 1.0;
    const double farthest =
        glm::length(hull.centre - light.position) + glm::length(glm::dvec3(hull.half[0], hull.half[1], hull.half[2]));
    double nearest = 1e300, longest = 0.0;
    for (int i = 0; i < 3; ++i) {
        nearest = std::min(nearest, glm::length(corners[i] - light.position));
        longest = std::max(longest, glm::length(corners[i] - corners[(i + 1) % 3]));
    }
    const double distance = std::max({lightHeight, nearest - longest, 1e-300});
    return std::max(1.0, farthest / distance);
}

} // namespace

lanes::ShadowPlanes shadowOf(const ShaftLight& light, const Hull& hull, const glm::dvec3 (&corners)[3],
                             glm::dvec3 rounding, bool opaque, glm::dvec3 centre)
{
    Seen seen = look(light, corners, rounding);
    const double wider = magnification(light, hull, corners, seen.lightHeight);
    lanes::ShadowPlanes planes{};
    bool edgeOn = false; // so narrow that it is not known which side of a wall is which
    for (int i = 0; i < 3; ++i)
        edgeOn = edgeOn || !(seen.height[i] > 4.0 * seen.edges[i].margin);
    if (edgeOn) {
        // What is left of it lies between two parallel walls, to each side of the edge that fits best.
        int best = 0;
        double thickness[3];
        for (int i = 0; i < 3; ++i) {
            thickness[i] = 0.0;
            for (const glm::dvec3& corner : corners)
                thickness[i] =
                    std::max(thickness[i], std::abs(glm::dot(seen.edges[i].normal, corner) + seen.edges[i].distance));
            best = thickness[i] < thickness[best] ? i : best;
        }
        const Wall wall = seen.edges[best];
        const double band = (thickness[best] + wall.margin) * wider;
        const bool known = band < 1e18; // else wherever the shaft has met it
        const Wall walls[4] = {known ? Wall{wall.normal, wall.distance + band, wall.margin} : Wall{},
                               known ? Wall{-wall.normal, band - wall.distance, wall.margin} : Wall{}, Wall{}, Wall{}};
        for (int i = 0; i < 4; ++i)
            store(walls[i], hull, centre, i, planes);
        return planes;
    }
    for (int i = 0; i < 3; ++i) {
        seen.edges[i].margin *= wider;
        store(seen.edges[i], hull, centre, i, planes);
    }
    store(seen.own, hull, centre, 3, planes);
    // Rays end an offset before the light: what could lie behind that end proves nothing.
    const bool before = light.directional || seen.lightHeight > 2.0 * hull.largestOffset + 2.0 * seen.own.margin;
    planes.certain = opaque && before ? 1 : 0;
    return planes;
}

} // namespace gnomon
