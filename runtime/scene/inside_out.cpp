#include "runtime/scene/inside_out.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/scene/mesh_clusters.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon {

namespace {

// Of the sum of all tetrahedra, whichever way they count: less is the rounding of a surface without a volume, such as a
// sheet with two sides. Double precision leaves some 1e-16 a face.
constexpr double kLeastVolume = 1e-9;

// Solid angles that may be added up for one mesh: some 30 ns each, half a second together.
constexpr std::size_t kMostAngles = std::size_t{1} << 24;

// Places at which a shell is asked whether others wind about it.
constexpr std::uint32_t kPlaces = 4;

struct Shell {
    bool watertight = true;
    std::uint32_t firstFace = UINT32_MAX;
    std::vector<std::uint32_t> places; ///< Faces, of those with a negative volume.
    double volume = 0.0;               ///< Six times the signed volume.
    double terms = 0.0;                ///< The same without signs.
    Aabb bounds;
};

std::uint32_t shellOf(const Topology& topology, std::uint32_t face)
{
    return topology.shellOfFace.empty() ? 0 : topology.shellOfFace[face];
}

struct Triangle {
    glm::dvec3 a, b, c;
};

Triangle triangleOf(const Topology& topology, std::span<const glm::vec3> positions, std::uint32_t face)
{
    const std::uint32_t* corner = &topology.faceVerts[std::size_t{3} * face];
    return {positions[corner[0]], positions[corner[1]], positions[corner[2]]};
}

/// How much more often a shell runs an edge forwards than backwards.
float signsOf(const Topology& topology, const Topology::Edge& edge, std::uint32_t shell)
{
    float sum = 0.0f;
    for (const Topology::EdgeUse& use : usesOf(topology, edge))
        if (shellOf(topology, use.face) == shell) sum += use.sign;
    return sum;
}

std::vector<Shell> measureShells(const Topology& topology, std::span<const glm::vec3> positions)
{
    const auto faces = static_cast<std::uint32_t>(topology.faceVerts.size() / 3);
    std::vector<Shell> shells(topology.shellOfFace.empty() ? 1 : topology.shellCount);
    for (std::uint32_t face = 0; face < faces; ++face) {
        Shell& shell = shells[shellOf(topology, face)];
        shell.firstFace = std::min(shell.firstFace, face);
        const Triangle t = triangleOf(topology, positions, face);
        const glm::dvec3 from = triangleOf(topology, positions, shell.firstFace).a;
        const double six = glm::dot(t.a - from, glm::cross(t.b - from, t.c - from));
        shell.volume += six;
        shell.terms += std::abs(six);
        const glm::vec3 lower(glm::min(t.a, glm::min(t.b, t.c))), upper(glm::max(t.a, glm::max(t.b, t.c)));
        shell.bounds = shell.firstFace == face ? Aabb{lower, upper} : unionOf(shell.bounds, {lower, upper});
    }
    for (const Topology::Edge& edge : topology.edges)
        for (const Topology::EdgeUse& use : usesOf(topology, edge)) {
            const std::uint32_t shell = shellOf(topology, use.face);
            if (signsOf(topology, edge, shell) != 0.0f) shells[shell].watertight = false;
            if (edge.useCount > kMostUses) break; // all of them are in one shell
        }
    return shells;
}

/// The signed solid angle of a triangle over 2 pi.
/// Source: A. van Oosterom and J. Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2),
/// 1983.
double halfTurns(const Triangle& t, const glm::dvec3& from)
{
    constexpr double kPi = 3.14159265358979323846;
    const glm::dvec3 a = t.a - from, b = t.b - from, c = t.c - from;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double above = glm::dot(a, glm::cross(b, c));
    const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return std::atan2(above, below) / kPi;
}

bool holds(const Aabb& box, const glm::dvec3& p)
{
    return glm::all(glm::lessThanEqual(glm::dvec3(box.lower), p)) &&
           glm::all(glm::lessThanEqual(p, glm::dvec3(box.upper)));
}

/// Whether other shells wind about this one: a cavity. @param budget of solid angles; 0 afterwards: it ran out
bool isCavity(const Topology& topology, std::span<const glm::vec3> positions, std::span<const Shell> shells,
              std::uint32_t shell, std::size_t& budget)
{
    const auto faces = static_cast<std::uint32_t>(topology.faceVerts.size() / 3);
    for (const std::uint32_t place : shells[shell].places) {
        if (faces > budget) return budget = 0, false;
        budget -= faces;
        const Triangle at = triangleOf(topology, positions, place);
        const glm::dvec3 center = (at.a + at.b + at.c) / 3.0;
        double turns = 0.0;
        for (std::uint32_t face = 0; face < faces; ++face) {
            const std::uint32_t other = shellOf(topology, face);
            if (other != shell && shells[other].watertight && holds(shells[other].bounds, center))
                turns += 0.5 * halfTurns(triangleOf(topology, positions, face), center);
        }
        if (!(turns > 0.75)) return false; // 1/2 where the place lies on the other shell
    }
    return true;
}

/// Some faces of every shell of negative volume, spread over it.
void choosePlaces(const Topology& topology, std::span<Shell> shells)
{
    std::vector<std::uint32_t> faces(shells.size(), 0), seen(shells.size(), 0);
    for (std::uint32_t face = 0; face < topology.faceVerts.size() / 3; ++face)
        ++faces[shellOf(topology, face)];
    for (std::uint32_t face = 0; face < topology.faceVerts.size() / 3; ++face) {
        const std::uint32_t shell = shellOf(topology, face);
        const std::uint32_t step = std::max(1u, faces[shell] / kPlaces);
        if (seen[shell]++ % step == 0 && shells[shell].places.size() < kPlaces) shells[shell].places.push_back(face);
    }
}

} // namespace

void judgeOrientation(Topology& topology, std::span<const glm::vec3> positions)
{
    for (Topology::Cluster& cluster : topology.clusters)
        cluster.insideOut = false;
    std::vector<Shell> shells = measureShells(topology, positions);
    const auto negative = [](const Shell& shell) {
        return shell.watertight && shell.volume < -kLeastVolume * shell.terms;
    };
    if (std::any_of(shells.begin(), shells.end(), negative)) {
        choosePlaces(topology, shells);
        std::size_t budget = kMostAngles;
        for (std::uint32_t shell = 0; shell < shells.size(); ++shell) {
            if (!negative(shells[shell])) continue;
            const std::uint32_t face = shells[shell].firstFace;
            Topology::Cluster& cluster =
                topology.clusters[topology.clusterOfFace.empty() ? 0 : topology.clusterOfFace[face]];
            if (!cluster.insideOut) cluster.insideOut = !isCavity(topology, positions, shells, shell, budget);
        }
    }
    Topology::Cluster& whole = topology.whole;
    whole.watertight = !topology.edges.empty();
    whole.insideOut = false;
    for (Topology::Cluster& cluster : topology.clusters) {
        cluster.closed = cluster.watertight && !cluster.insideOut;
        whole.watertight = whole.watertight && cluster.watertight;
        whole.insideOut = whole.insideOut || cluster.insideOut;
    }
    whole.closed = topology.closed = whole.watertight && !whole.insideOut;
}

} // namespace gnomon
