#include "algorithms/hybrid/shaft.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/hybrid/float4.hpp"

namespace gnomon {

namespace {

// The unit roundoff of single precision.
constexpr double kRoundoff = 0x1p-24;
// A ray on its way to mesh space: three products and a sum of each coordinate, and the matrix's own rounding.
constexpr double kRayRoundings = 4.0 * kRoundoff;
// Our own sums of three products and a distance in single precision: five roundings of their largest term, and the
// same again for the planes that were rounded.
constexpr double kSumRoundings = 10.0 * kRoundoff;

glm::dvec3 largestOf(const Aabb& box)
{
    return glm::dvec3(glm::max(glm::abs(box.lower), glm::abs(box.upper)));
}

glm::dvec3 anyPerpendicular(glm::dvec3 unit)
{
    const glm::dvec3 away = std::abs(unit.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(unit, away));
}

/// `wanted` made perpendicular to `unit`; any direction where nothing is left of it.
glm::dvec3 perpendicular(glm::dvec3 unit, glm::dvec3 wanted)
{
    const glm::dvec3 rest = wanted - unit * glm::dot(unit, wanted);
    const double size = glm::length(rest);
    return size > 1e-4 * glm::length(wanted) ? rest / size : anyPerpendicular(unit);
}

} // namespace

ShaftLight::ShaftLight(const LightView& light)
    : directional(light.type == GN_LIGHT_TYPE_DIRECTIONAL), position(light.position()),
      toLight(directional ? -glm::normalize(glm::dvec3(light.direction())) : glm::dvec3(0.0))
{
}

glm::dvec3 Hull::extent() const
{
    return glm::abs(axis[0]) * half[0] + glm::abs(axis[1]) * half[1] + glm::abs(axis[2]) * half[2];
}

glm::dvec3 Hull::largest() const
{
    return glm::abs(centre) + extent();
}

void Hull::turn(glm::dvec3 normals, glm::dvec3 row)
{
    const double size = glm::length(normals);
    axis[2] = size > 1e-6 && size < 1e30 ? normals / size : glm::dvec3(0, 1, 0);
    axis[0] = perpendicular(axis[2], row);
    axis[1] = glm::cross(axis[2], axis[0]);
}

bool hullOf(const simd::Kernels& kernels, const simd::Block* blocks, std::uint32_t count, glm::vec3 row, Hull& hull)
{
    glm::dvec3 normal(0.0);
    const simd::Block* first = nullptr;
    hull.largestOffset = 0.0;
    bool finite = true;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (blocks[i].rays == 0) continue;
        if (!first) first = blocks + i;
        finite = finite && blocks[i].finite != 0;
        hull.largestOffset = std::max(hull.largestOffset, double(blocks[i].largestOffset));
        normal += glm::dvec3(blocks[i].normalSum[0], blocks[i].normalSum[1], blocks[i].normalSum[2]);
    }
    if (!first || !finite) return false;
    hull.turn(normal, row);

    constexpr float infinity = std::numeric_limits<float>::infinity();
    const float start[3] = {first->origin[0][0], first->origin[1][0], first->origin[2][0]};
    float axes[3][3], lower[3] = {infinity, infinity, infinity}, upper[3] = {-infinity, -infinity, -infinity};
    for (int i = 0; i < 3; ++i) {
        const glm::vec3 rounded(hull.axis[i]);
        for (int k = 0; k < 3; ++k)
            axes[i][k] = rounded[k];
    }
    kernels.bound(blocks, count, start, axes, lower, upper);
    hull.centre = {start[0], start[1], start[2]};
    double farthest = 0.0;
    for (int i = 0; i < 3; ++i)
        farthest = std::max({farthest, std::abs(double(lower[i])), std::abs(double(upper[i]))});
    for (int i = 0; i < 3; ++i) {
        hull.centre += hull.axis[i] * (0.5 * (double(lower[i]) + double(upper[i])));
        hull.half[i] = 0.5 * (double(upper[i]) - double(lower[i])) + 2.0 * kSumRoundings * farthest;
    }
    return true;
}

namespace {

/// Sides of the shaft: four planes that the light and the hull's corners span.
void addSides(const ShaftLight& light, const Hull& hull, glm::dvec3 towards, Shaft& shaft)
{
    const glm::dvec3 u = perpendicular(towards, hull.axis[0]), v = glm::cross(towards, u);
    double lower[2] = {1e300, 1e300}, upper[2] = {-1e300, -1e300};
    bool behind = false; // of a corner, the light: nothing is known
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec3 p = hull.centre;
        for (int i = 0; i < 3; ++i)
            p += hull.axis[i] * (corner >> i & 1 ? hull.half[i] : -hull.half[i]);
        double scale = 1.0;
        if (!light.directional) {
            p -= light.position;
            const double depth = -glm::dot(towards, p);
            behind = behind || !(depth > 1e-6 * glm::length(p));
            scale = behind ? 1.0 : 1.0 / depth;
        }
        const double at[2] = {glm::dot(u, p) * scale, glm::dot(v, p) * scale};
        for (int i = 0; i < 2; ++i) {
            lower[i] = std::min(lower[i], at[i]);
            upper[i] = std::max(upper[i], at[i]);
        }
    }
    const glm::dvec3 across[2] = {u, v};
    for (int i = 0; i < 4; ++i) {
        const bool low = i % 2 == 0;
        const double limit = low ? lower[i / 2] : upper[i / 2], sign = low ? 1.0 : -1.0;
        glm::dvec3 normal = across[i / 2];
        double distance = -limit;
        if (!light.directional) { // u.p / -towards.p >= limit
            normal += towards * limit;
            const double size = glm::length(normal);
            normal /= size;
            distance = -glm::dot(normal, light.position);
        }
        shaft.normal[i] = behind ? glm::dvec3(0.0) : sign * normal;
        shaft.distance[i] = behind ? 1.0 : sign * distance;
    }
}

} // namespace

Shaft shaftOf(const ShaftLight& light, const Hull& hull)
{
    Shaft shaft;
    shaft.largest = glm::max(hull.largest(), light.largest());
    glm::dvec3 towards = light.toLight;
    const glm::dvec3 toLight = light.position - hull.centre;
    if (!light.directional) towards = toLight / std::max(glm::length(toLight), 1e-20);
    if (!(glm::dot(towards, towards) > 0.5)) towards = {0, 1, 0};
    addSides(light, hull, towards, shaft);
    // Along the receivers' normal and along the way to the light: nothing is lower than the hull's lowest corner and
    // the light.
    const glm::dvec3 up[2] = {hull.axis[2], towards};
    for (int i = 0; i < 2; ++i) {
        double lowest = -hull.radius(up[i]);
        bool bounded = true;
        if (light.directional)
            bounded = glm::dot(up[i], towards) >= 0.0;
        else
            lowest = std::min(lowest, glm::dot(up[i], toLight));
        shaft.normal[4 + i] = bounded ? up[i] : glm::dvec3(0.0);
        shaft.distance[4 + i] = bounded ? -glm::dot(up[i], hull.centre) - lowest : 1.0;
    }
    return shaft;
}

ShaftCaster::ShaftCaster(const Caster& caster)
    : CasterReach{.translation = caster.translation, .reach = largestOf(caster.bounds)}, mesh(caster.mesh),
      tree(caster.mesh->rays->tree().get()), basis(caster.basis),
      meshReach(glm::max(glm::abs(caster.mesh->bounds.lower), glm::abs(caster.mesh->bounds.upper))),
      opaque(opacityOf(caster) == nullptr)
{
    spread = spreadOf(basis);
}

glm::dvec3 CasterReach::rounding(glm::dvec3 largestCoordinates) const
{
    return kRayRoundings * (spread * (largestCoordinates + glm::abs(translation)));
}

MeshShaft::MeshShaft(const Shaft& shaft, const ShaftCaster* caster, glm::dvec3 rounding, glm::vec3 reach)
{
    for (int i = 0; i < Shaft::kPlanes; ++i) {
        glm::dvec3 n = shaft.normal[i];
        double d = shaft.distance[i] + glm::dot(glm::abs(n), rounding);
        if (caster) {
            d += glm::dot(n, caster->translation);
            n = n * caster->basis; // transposed
        }
        d += kSumRoundings * (glm::dot(glm::abs(n), glm::dvec3(reach)) + std::abs(d));
        for (int k = 0; k < 3; ++k) {
            normal[i][k] = allFour(static_cast<float>(n[k]));
            outer[i][k] = static_cast<std::uint8_t>(n[k] >= 0.0 ? 3 + k : k);
        }
        distance[i] = allFour(static_cast<float>(d));
    }
}

namespace {

/// A row of a node's boxes: their lower ends along x, y, z, then their upper ends.
Float4 rowOf(const TriangleTree::Node& node, std::uint32_t row)
{
    static_assert(offsetof(TriangleTree::Node, upper) == offsetof(TriangleTree::Node, lower) + 3 * sizeof(Float4));
    return load(&node.lower[0][0] + row * TriangleTree::kWidth);
}

} // namespace

std::uint32_t MeshShaft::touches(const TriangleTree::Node& node) const
{
    Int4 outside = {};
    for (int i = 0; i < Shaft::kPlanes; ++i)
        outside |= rowOf(node, outer[i][0]) * normal[i][0] + rowOf(node, outer[i][1]) * normal[i][1] +
                       rowOf(node, outer[i][2]) * normal[i][2] + distance[i] <
                   0.0f;
    return ~bitsOf(outside) & ((1u << node.count) - 1u);
}

std::uint32_t MeshShaft::spannedBy(const TriangleTree::Node& node) const
{
    Int4 within = {};
    for (int i = 0; i < Shaft::kSides; ++i) {
        Float4 nearest = distance[i]; // of the corners
        for (std::uint32_t k = 0; k < 3; ++k)
            nearest += rowOf(node, outer[i][k] == k ? k + 3 : k) * normal[i][k];
        within |= nearest > 0.0f;
    }
    return ~bitsOf(within) & ((1u << node.count) - 1u);
}

} // namespace gnomon
