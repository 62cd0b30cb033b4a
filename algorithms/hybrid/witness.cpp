#include "algorithms/hybrid/witness.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/common/caster_lists.hpp"

namespace gnomon {

namespace {

// The tracer rounds to 24 bits: the ray moved into the object (3 products and sums a coordinate), corners minus origin,
// their products. Counted out that is about 10 half units in the last place of the largest coordinate involved; this is
// 16 of them (8 units, 2^-23 each). What is not safe by that much is left to the tracer itself.
constexpr double kSlack = 0x1p-20;

/// A bound of the length that costs no root.
double size1(const glm::dvec3& v)
{
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

/// Product of the largest stretches of a matrix and of its inverse, at least 1.
float stretchOf(const glm::mat3& basis)
{
    const auto norm = [](const glm::dmat3& m) { return std::max({size1(m[0]), size1(m[1]), size1(m[2])}); };
    const glm::dmat3 forward(basis);
    // Of a rotation both are at most sqrt 3: no more than what is safe anyway.
    return static_cast<float>(std::max(1.0, norm(forward) * norm(glm::inverse(forward)) / 3.0));
}

/// As RayScene::update has it.
bool traced(const Caster& caster)
{
    return caster.mesh && caster.mesh->rays && std::isfinite(1.0f / glm::determinant(caster.basis));
}

} // namespace

bool hitsInside(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& direction, double tfar,
                double size)
{
    const glm::dvec3 ab = b - a, bc = c - b, ca = a - c;
    // The volumes spanned by the ray and an edge: all of one sign where the line passes inside.
    const double volumes[3] = {glm::dot(direction, glm::cross(a, b)), glm::dot(direction, glm::cross(b, c)),
                               glm::dot(direction, glm::cross(c, a))};
    const double sign = volumes[0] > 0.0 ? 1.0 : -1.0;
    const double along = size1(direction), slack = kSlack * size;
    const double lengths[3] = {size1(ab), size1(bc), size1(ca)};
    for (int edge = 0; edge < 3; ++edge)
        if (sign * volumes[edge] < slack * lengths[edge] * along) return false;

    const glm::dvec3 normal = glm::cross(ab, bc);
    const double toPlane = glm::dot(a, normal), perLength = glm::dot(direction, normal);
    const double facing = perLength > 0.0 ? 1.0 : -1.0;
    // Near the plane the tracer's rounding is that of the products of two edges.
    const double planeSlack = slack * lengths[0] * lengths[1];
    if (facing * toPlane < planeSlack) return false;
    if (!std::isfinite(tfar)) return true;
    const double end = tfar * std::abs(perLength);
    return facing * toPlane < end - planeSlack - kSlack * tfar * along * lengths[0] * lengths[1];
}

NumberedTriangles::NumberedTriangles(std::span<const Caster* const> casters, RingsCache* cache, FrameArena& arena)
    : entries_(arena.array<Entry>(casters.size()))
{
    Stamp stamp;
    std::uint32_t next = 0;
    std::size_t count = 0;
    for (const Caster* caster : casters) {
        if (!caster->mesh) continue; // drawn by the host: no triangles of ours
        const bool opaque = !(caster->alphaTested && caster->opacity);
        entries_[count++] = {.caster = caster,
                             .rings = cache ? cache->find(*caster->mesh) : nullptr,
                             .first = next,
                             .stretch = stretchOf(caster->basis),
                             .testifies = opaque && traced(*caster)};
        stamp.add(std::uint64_t{caster->id}).add(std::uint64_t{caster->mesh->triangleCount()});
        next += caster->mesh->triangleCount();
    }
    entries_ = entries_.first(count);
    stamp_ = stamp.value();
}

const NumberedTriangles::Entry& NumberedTriangles::of(std::uint32_t number) const
{
    const auto after = std::upper_bound(entries_.begin(), entries_.end(), number,
                                        [](std::uint32_t n, const Entry& entry) { return n < entry.first; });
    return *(after - 1);
}

bool NumberedTriangles::blocks(std::uint32_t number, const ShadowRay& ray) const
{
    const Entry& entry = of(number);
    if (!entry.testifies) return false;
    const Caster& caster = *entry.caster;
    const MeshView& mesh = *caster.mesh;
    const std::uint32_t* corners = mesh.indices.data() + std::size_t{3} * (number - entry.first);
    const glm::dmat3 basis(caster.basis);
    const glm::dvec3 offset = glm::dvec3(caster.translation) - glm::dvec3(ray.origin);
    const glm::dvec3 a = basis * glm::dvec3(mesh.positions[corners[0]]) + offset;
    const glm::dvec3 b = basis * glm::dvec3(mesh.positions[corners[1]]) + offset;
    const glm::dvec3 c = basis * glm::dvec3(mesh.positions[corners[2]]) + offset;
    const double size = (size1(caster.translation) + size1(ray.origin) + std::max({size1(a), size1(b), size1(c)})) *
                        static_cast<double>(entry.stretch);
    return hitsInside(a, b, c, ray.direction, static_cast<double>(ray.tfar), size);
}

} // namespace gnomon
