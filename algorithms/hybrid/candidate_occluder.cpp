#include "algorithms/hybrid/candidate_occluder.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/shared/caster_lists.hpp"

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

} // namespace

CandidateOccluder candidateOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    return {.a = a,
            .b = b,
            .c = c,
            .normal = glm::cross(b - a, c - b),
            .lengths = {size1(b - a), size1(c - b), size1(a - c)},
            .size = std::max({size1(a), size1(b), size1(c)}),
            .stretch = 1.0};
}

bool blocks(const CandidateOccluder& candidate, const ShadowRay& ray)
{
    const glm::dvec3 origin(ray.origin), direction(ray.direction);
    const double slack = kSlack * candidate.stretch * (candidate.size + 2.0 * size1(origin));
    const glm::dvec3 a = candidate.a - origin;
    const double perLength = glm::dot(direction, candidate.normal), facing = perLength > 0.0 ? 1.0 : -1.0;
    const double toPlane = facing * glm::dot(a, candidate.normal);
    // How far off the tracer may be with the plane is the rounding of products of two edges.
    const double edges = candidate.lengths[0] * candidate.lengths[1];
    if (!(toPlane > slack * edges)) return false;
    const double along = size1(direction);
    if (std::isfinite(ray.tfar)) {
        const auto end = static_cast<double>(ray.tfar);
        if (!(toPlane < end * std::abs(perLength) - (slack + kSlack * end * along) * edges)) return false;
    }
    // The volumes spanned by the ray and an edge have the sign of their sum where the line passes inside.
    const glm::dvec3 b = candidate.b - origin, c = candidate.c - origin;
    const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to, double length) {
        return facing * glm::dot(direction, glm::cross(from, to)) > slack * length * along;
    };
    return inside(a, b, candidate.lengths[0]) && inside(b, c, candidate.lengths[1]) &&
           inside(c, a, candidate.lengths[2]);
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
                             .testifies = opaque && castsRays(*caster)};
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

const std::uint32_t* NumberedTriangles::corners(std::uint32_t number) const
{
    const Entry& entry = of(number);
    return entry.caster->mesh->indices.data() + std::size_t{3} * (number - entry.first);
}

std::optional<CandidateOccluder> NumberedTriangles::candidate(std::uint32_t number) const
{
    const Entry& entry = of(number);
    if (!entry.testifies) return std::nullopt;
    const Caster& caster = *entry.caster;
    const std::uint32_t* corners = caster.mesh->indices.data() + std::size_t{3} * (number - entry.first);
    const glm::dmat3 basis(caster.basis);
    const glm::dvec3 translation(caster.translation);
    const auto world = [&](std::uint32_t corner) {
        return basis * glm::dvec3(caster.mesh->positions[corner]) + translation;
    };
    CandidateOccluder candidate = candidateOf(world(corners[0]), world(corners[1]), world(corners[2]));
    candidate.size += size1(translation);
    candidate.stretch = static_cast<double>(entry.stretch);
    return candidate;
}

bool CandidateOccluders::blocks(std::uint32_t number, const ShadowRay& ray)
{
    Kept& kept = kept_[number % kPlaces];
    if (kept.number != number) kept = {number, triangles_.candidate(number)};
    return kept.candidate && gnomon::blocks(*kept.candidate, ray);
}

} // namespace gnomon
