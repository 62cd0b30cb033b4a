#include "algorithms/volumes/shadow_region.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/scene/topology.hpp"

namespace gnomon {

namespace {

// Faces of a mesh that is tried as an occluder: every plane costs every tile, and a box has twelve.
constexpr std::size_t kMostFaces = 64;

// How far, in sizes of the caster, vertices may lie before a face of what is called convex: the rounding of positions
// (2^-24) and of their transform, some ten times.
constexpr double kConvex = 1e-6;

glm::vec4 rounded(const glm::dvec3& normal, double distance)
{
    return glm::vec4(glm::vec3(normal), static_cast<float>(distance));
}

/// The tangents from the light to the box, seen along one axis: they touch an edge that is parallel to it.
int addTangents(int axis, const Aabb& box, const LightView& light, glm::vec4* out)
{
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const glm::dvec2 corners[4] = {{box.lower[i], box.lower[j]},
                                   {box.upper[i], box.lower[j]},
                                   {box.upper[i], box.upper[j]},
                                   {box.lower[i], box.upper[j]}};
    if (!directional) {
        // Between the box's sides, or on one: light goes round every edge parallel to the axis.
        const glm::vec3 p = light.position(), margin = 1e-6f * (glm::abs(p) + 1.0f);
        const auto between = [&](int k) {
            return p[k] >= box.lower[k] - margin[k] && p[k] <= box.upper[k] + margin[k];
        };
        if (between(i) && between(j)) return 0;
    }
    int count = 0;
    // One to each side; where two corners lie on a tangent, either gives it.
    for (const double turn : {1.0, -1.0}) {
        for (const glm::dvec2& corner : corners) {
            const glm::dvec2 ray = directional ? glm::dvec2(light.direction()[i], light.direction()[j])
                                               : corner - glm::dvec2(light.position()[i], light.position()[j]);
            const double length = glm::length(ray);
            if (!(length > 1e-9)) continue; // along the axis: no edge bounds anything
            const glm::dvec2 normal = glm::dvec2(-ray.y, ray.x) * (turn / length);
            const double distance = -glm::dot(normal, corner);
            const bool outermost = std::all_of(corners, corners + 4, [&](const glm::dvec2& other) {
                return glm::dot(normal, other) + distance <= 1e-9 * (1.0 + std::abs(distance));
            });
            if (!outermost) continue;
            glm::dvec3 full(0.0);
            full[i] = normal.x;
            full[j] = normal.y;
            out[count++] = rounded(full, distance);
            break;
        }
    }
    return count;
}

struct WorldMesh {
    std::vector<glm::dvec3> positions; ///< Of the face corners, three a face.
    glm::dvec3 center{0.0};
    double size = 0.0;
};

WorldMesh worldMesh(const Caster& caster, const Topology::Cluster& cluster)
{
    WorldMesh mesh;
    const Topology& topology = *caster.mesh->topology;
    mesh.positions.reserve(std::size_t{3} * cluster.faceCount);
    for (std::uint32_t i = 0; i < 3 * cluster.faceCount; ++i) {
        const std::size_t face = topology.faceAt(cluster.firstFace + i / 3);
        const glm::dvec3 p =
            glm::dmat3(caster.basis) * glm::dvec3(caster.mesh->positions[topology.faceVerts[3 * face + i % 3]]) +
            glm::dvec3(caster.translation);
        mesh.positions.push_back(p);
        mesh.center += p / (3.0 * cluster.faceCount);
    }
    for (const glm::dvec3& p : mesh.positions)
        mesh.size = std::max(mesh.size, glm::length(p - mesh.center));
    return mesh;
}

/// Through three points, with the centre inside. False: no such plane, or the centre lies on it.
bool planeThrough(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const WorldMesh& mesh,
                  glm::dvec3& normal, double& distance)
{
    normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    if (!(length > 1e-9 * mesh.size * glm::length(c - a))) return false;
    normal /= length;
    distance = -glm::dot(normal, a);
    const double center = glm::dot(normal, mesh.center) + distance;
    if (std::abs(center) <= 100.0 * kConvex * mesh.size) return false;
    if (center > 0.0) {
        normal = -normal;
        distance = -distance;
    }
    return true;
}

void addOnce(std::vector<glm::vec4>& planes, const glm::vec4& plane)
{
    const bool known =
        std::any_of(planes.begin(), planes.end(), [&](const glm::vec4& other) { return plane == other; });
    if (!known) planes.push_back(plane);
}

/// Sorts the planes of the faces, in their order in the cluster, by whether they look towards the light. False: it is
/// not convex.
bool sortFaces(const WorldMesh& mesh, const LightView& light, Umbra& umbra, std::vector<bool>& lit)
{
    for (std::size_t face = 0; face < mesh.positions.size() / 3; ++face) {
        const glm::dvec3* corner = &mesh.positions[3 * face];
        glm::dvec3 normal;
        double distance = 0.0;
        if (!planeThrough(corner[0], corner[1], corner[2], mesh, normal, distance)) return false;
        for (const glm::dvec3& p : mesh.positions)
            if (glm::dot(normal, p) + distance > kConvex * mesh.size) return false;
        const double towards = light.type == GN_LIGHT_TYPE_DIRECTIONAL
                                   ? -glm::dot(normal, glm::dvec3(light.direction()))
                                   : glm::dot(normal, glm::dvec3(light.position())) + distance;
        lit[face] = towards > 0.0;
        addOnce(lit[face] ? umbra.planes : umbra.away, rounded(normal, distance));
    }
    return true;
}

/// The planes through the light and the edges between lit and unlit faces. False: an edge says nothing.
bool addSilhouette(const Caster& caster, const Topology::Cluster& cluster, const WorldMesh& mesh,
                   const LightView& light, const std::vector<bool>& lit, Umbra& umbra)
{
    const Topology& topology = *caster.mesh->topology;
    const auto isLit = [&](const Topology::EdgeUse& use) {
        std::uint32_t place = 0;
        while (topology.faceAt(cluster.firstFace + place) != use.face)
            ++place;
        return lit[place];
    };
    for (const Topology::Edge& edge : edgesOf(topology, cluster)) {
        if (edge.useCount != 2) return false;
        if (isLit(topology.uses[edge.firstUse]) == isLit(topology.uses[edge.firstUse + 1])) continue;
        const auto world = [&](std::uint32_t vertex) {
            return glm::dmat3(caster.basis) * glm::dvec3(caster.mesh->positions[vertex]) +
                   glm::dvec3(caster.translation);
        };
        const glm::dvec3 a = world(edge.v0), b = world(edge.v1);
        const glm::dvec3 third = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? a - mesh.size * glm::dvec3(light.direction())
                                                                         : glm::dvec3(light.position());
        glm::dvec3 normal;
        double distance = 0.0;
        if (!planeThrough(a, b, third, mesh, normal, distance)) return false;
        addOnce(umbra.planes, rounded(normal, distance));
    }
    return true;
}

} // namespace

BoxShadow boxShadow(const Aabb& box, const LightView& light)
{
    BoxShadow shadow;
    std::fill_n(shadow.planes, gpu::SHADOW_PLANES, gpu::nowhereOutside());
    glm::vec4* next = shadow.planes;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    for (int axis = 0; axis < 3; ++axis) {
        // The sides of the box that look towards the light bound its shadow: one a axis at most.
        const float towards = directional ? -light.direction()[axis] : light.position()[axis];
        const bool beforeLower = directional ? towards < 0.0f : towards < box.lower[axis];
        const bool beyondUpper = directional ? towards > 0.0f : towards > box.upper[axis];
        glm::vec4 plane(0.0f);
        if (beforeLower || beyondUpper) {
            plane[axis] = beforeLower ? -1.0f : 1.0f;
            plane.w = beforeLower ? box.lower[axis] : -box.upper[axis];
            *next++ = plane;
        }
        next += addTangents(axis, box, light, next);
    }
    return shadow;
}

std::optional<Umbra> umbraOf(const VolumeSource& source, const LightView& light)
{
    const Caster& caster = *source.caster;
    if (!caster.mesh || !caster.mesh->topology || caster.hostDrawn || caster.alphaTested) return std::nullopt;
    const Topology::Cluster& cluster = source.shape();
    if (!cluster.closed || cluster.faceCount == 0 || cluster.faceCount > kMostFaces) return std::nullopt;
    const WorldMesh mesh = worldMesh(caster, cluster);
    Umbra umbra;
    std::vector<bool> lit(cluster.faceCount);
    if (!sortFaces(mesh, light, umbra, lit)) return std::nullopt;
    if (umbra.planes.empty() || umbra.away.empty()) return std::nullopt;
    if (!addSilhouette(caster, cluster, mesh, light, lit, umbra)) return std::nullopt;
    if (umbra.planes.size() > gpu::UMBRA_PLANES) return std::nullopt;
    return umbra;
}

bool conceals(const Umbra& umbra, const Aabb& box)
{
    const glm::vec3 center = box.center(), half = box.halfExtent();
    const auto within = [&](const glm::vec4& plane) { return gpu::boxWithin(plane, center, half, kUmbraMargin); };
    if (!std::all_of(umbra.planes.begin(), umbra.planes.end(), within)) return false;
    // Standing on the caster is outside of it; the rounding of a coordinate is not inside.
    const float touching = 1e-6f * (glm::length(center) + glm::length(half));
    return std::any_of(umbra.away.begin(), umbra.away.end(),
                       [&](const glm::vec4& plane) { return gpu::boxBeyond(plane, center, half, -touching); });
}

} // namespace gnomon
