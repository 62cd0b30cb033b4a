#include "runtime/scene/topology.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/scene/inside_out.hpp"
#include "runtime/scene/mesh_clusters.hpp"

#ifdef GNOMON_WITH_OPENMESH
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#endif

namespace gnomon {

namespace {

void updatePlanes(Topology& topology, std::span<const glm::vec3> positions)
{
    topology.facePlanes.resize(topology.faceVerts.size() / 3);
    for (std::size_t face = 0; face < topology.facePlanes.size(); ++face) {
        const std::uint32_t* corner = &topology.faceVerts[3 * face];
        const glm::vec3 a = positions[corner[0]];
        const glm::vec3 normal = glm::cross(positions[corner[1]] - a, positions[corner[2]] - a);
        topology.facePlanes.set(face, glm::vec4(normal, -glm::dot(normal, a)));
    }
}

void updateBounds(Topology& topology, std::span<const glm::vec3> positions)
{
    for (Topology::Cluster& cluster : topology.clusters) {
        if (cluster.faceCount == 0) continue; // of nothing
        const glm::vec3 any = positions[topology.faceVerts[std::size_t{3} * topology.faceAt(cluster.firstFace)]];
        cluster.bounds = {any, any};
        for (std::uint32_t place = cluster.firstFace; place < cluster.firstFace + cluster.faceCount; ++place) {
            const std::uint32_t* corner = &topology.faceVerts[std::size_t{3} * topology.faceAt(place)];
            for (int i = 0; i < 3; ++i)
                cluster.bounds = unionOf(cluster.bounds, {positions[corner[i]], positions[corner[i]]});
        }
    }
    topology.whole.bounds = topology.clusters.empty() ? Aabb{} : topology.clusters[0].bounds;
    for (const Topology::Cluster& cluster : topology.clusters)
        topology.whole.bounds = unionOf(topology.whole.bounds, cluster.bounds);
}

} // namespace

void updatePositions(Topology& topology, std::span<const glm::vec3> positions)
{
    updatePlanes(topology, positions);
    updateBounds(topology, positions);
    judgeOrientation(topology, positions);
}

#ifdef GNOMON_WITH_OPENMESH
namespace {

using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraits>;
using Corners = std::array<std::uint32_t, 3>;

// OpenMesh walks round a vertex for every face added to it, so a fan in unlucky order costs the square of its size:
// 0.09 s for 4 000 faces, 5 s for 30 000. Faces at vertices with more faces than this are kept as loose ones.
constexpr std::uint32_t kMaxValence = 4096;

/// Finds 32-bit ids by a 96-bit key; open addressing, at most half full.
class IdTable {
public:
    explicit IdTable(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), kEmpty), mask_(slots_.size() - 1) {}

    /// The id whose key equals this one by `equal(id)`, or `fresh`, which is then remembered.
    template <typename Equal>
    std::uint32_t findOrAdd(const Corners& key, std::uint32_t fresh, Equal&& equal)
    {
        // Three odd multipliers (64-bit golden ratio and two primes of xxHash), then the high half folded down.
        std::uint64_t hash = key[0] * 0x9e3779b97f4a7c15ull ^ key[1] * 0xc2b2ae3d27d4eb4full;
        hash = (hash ^ key[2]) * 0x165667b19e3779f9ull;
        std::size_t slot = (hash ^ hash >> 32) & mask_;
        while (slots_[slot] != kEmpty && !equal(slots_[slot]))
            slot = (slot + 1) & mask_;
        if (slots_[slot] == kEmpty) slots_[slot] = fresh;
        return slots_[slot];
    }

private:
    static constexpr std::uint32_t kEmpty = UINT32_MAX;
    std::vector<std::uint32_t> slots_;
    std::size_t mask_;
};

Corners bitsOf(const glm::vec3& p)
{
    const auto bits = [](float value) { return value == 0.0f ? 0u : std::bit_cast<std::uint32_t>(value); };
    return {bits(p.x), bits(p.y), bits(p.z)};
}

bool isDegenerate(const Corners& v)
{
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

/// Whether OpenMesh takes the face. It would answer by itself, but with a message on the process's standard error
/// through a stream that is shared by all threads; so its three refusals are asked for before.
bool accepts(const HalfEdges& mesh, const std::array<HalfEdges::VertexHandle, 3>& corners)
{
    std::array<HalfEdges::HalfedgeHandle, 3> edge;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!mesh.is_boundary(corners[i])) return false; // a closed fan takes no further face
        edge[i] = mesh.find_halfedge(corners[i], corners[(i + 1) % 3]);
        if (edge[i].is_valid() && !mesh.is_boundary(edge[i])) return false; // third face, or a flipped neighbour
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const auto in = edge[i], out = edge[(i + 1) % 3];
        if (!in.is_valid() || !out.is_valid() || mesh.next_halfedge_handle(in) == out) continue;
        // The fans between `in` and `out` must move to another gap of the vertex; without one they cannot.
        auto gap = mesh.opposite_halfedge_handle(out);
        do {
            gap = mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(gap));
        } while (!mesh.is_boundary(gap));
        if (gap == in) return false;
    }
    return true;
}

/// Edges and their uses while they are collected: `uses` in any order, tagged with the edge.
struct Collector {
    struct Use {
        std::uint32_t edge;
        Topology::EdgeUse use;
    };
    std::vector<Topology::Edge> edges;
    std::vector<Use> uses;

    /// Hands the lists to the topology, uses grouped by edge and in the order they came.
    void finish(Topology& topology)
    {
        for (const Use& use : uses)
            ++edges[use.edge].useCount;
        std::uint32_t first = 0;
        for (Topology::Edge& edge : edges) {
            edge.firstUse = first;
            first += edge.useCount;
            edge.useCount = 0;
        }
        topology.uses.resize(uses.size());
        for (const Use& use : uses) {
            Topology::Edge& edge = edges[use.edge];
            topology.uses[edge.firstUse + edge.useCount++] = use.use;
        }
        topology.edges = std::move(edges);
    }
};

/// Faces in OpenMesh, and the ones it refused.
struct Faces {
    HalfEdges mesh;
    std::vector<std::uint32_t> vertexOf; ///< OpenMesh vertex -> representative.
    std::vector<std::uint32_t> faceOf;   ///< OpenMesh face -> face.
    std::vector<std::uint32_t> loose;
};

void addFaces(Faces& faces, std::span<const std::uint32_t> verts, std::size_t positionCount)
{
    const std::size_t count = verts.size() / 3;
    std::vector<std::uint32_t> valence(positionCount, 0);
    for (const std::uint32_t v : verts)
        ++valence[v];

    std::vector<HalfEdges::VertexHandle> handle(positionCount);
    faces.mesh.reserve(positionCount, count + count / 2 + 16, count);
    faces.faceOf.reserve(count);
    for (std::uint32_t face = 0; face < count; ++face) {
        const Corners v{verts[3 * face], verts[3 * face + 1], verts[3 * face + 2]};
        bool fits = !isDegenerate(v);
        for (const std::uint32_t corner : v)
            fits = fits && valence[corner] <= kMaxValence;
        std::array<HalfEdges::VertexHandle, 3> corners;
        for (std::size_t i = 0; fits && i < 3; ++i) {
            if (!handle[v[i]].is_valid()) {
                handle[v[i]] = faces.mesh.new_vertex();
                faces.vertexOf.push_back(v[i]);
            }
            corners[i] = handle[v[i]];
        }
        if (fits && accepts(faces.mesh, corners) && faces.mesh.add_face(corners[0], corners[1], corners[2]).is_valid())
            faces.faceOf.push_back(face);
        else
            faces.loose.push_back(face);
    }
}

void collectHalfEdges(const Faces& faces, Collector& out)
{
    const std::size_t count = faces.mesh.n_edges();
    out.edges.reserve(count + 3 * faces.loose.size());
    out.uses.reserve(3 * (faces.faceOf.size() + faces.loose.size()));
    for (std::uint32_t e = 0; e < count; ++e) {
        const auto edge = HalfEdges::EdgeHandle(static_cast<int>(e));
        const auto forward = faces.mesh.halfedge_handle(edge, 0);
        const auto from = static_cast<std::size_t>(faces.mesh.from_vertex_handle(forward).idx());
        const auto to = static_cast<std::size_t>(faces.mesh.to_vertex_handle(forward).idx());
        out.edges.push_back({faces.vertexOf[from], faces.vertexOf[to], 0, 0});
        for (unsigned side = 0; side < 2; ++side) {
            const auto face = faces.mesh.face_handle(faces.mesh.halfedge_handle(edge, side));
            if (!face.is_valid()) continue;
            const std::uint32_t index = faces.faceOf[static_cast<std::size_t>(face.idx())];
            out.uses.push_back({e, {index, side == 0 ? 1.0f : -1.0f}});
        }
    }
}

void collectLoose(const Faces& faces, std::span<const std::uint32_t> verts, Collector& out)
{
    if (faces.loose.empty()) return;
    const auto key = [](std::uint32_t a, std::uint32_t b) { return Corners{std::min(a, b), std::max(a, b), 0}; };
    IdTable table(out.edges.size() + 3 * faces.loose.size());
    const auto find = [&](std::uint32_t a, std::uint32_t b, std::uint32_t fresh) {
        return table.findOrAdd(key(a, b), fresh, [&](std::uint32_t other) {
            return key(out.edges[other].v0, out.edges[other].v1) == key(a, b);
        });
    };
    for (std::uint32_t e = 0; e < out.edges.size(); ++e)
        find(out.edges[e].v0, out.edges[e].v1, e);
    for (const std::uint32_t face : faces.loose) {
        const Corners v{verts[3 * face], verts[3 * face + 1], verts[3 * face + 2]};
        if (isDegenerate(v)) continue; // encloses nothing: its edges cancel
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = v[i], b = v[(i + 1) % 3];
            const auto fresh = static_cast<std::uint32_t>(out.edges.size());
            const std::uint32_t edge = find(a, b, fresh);
            if (edge == fresh) out.edges.push_back({a, b, 0, 0});
            out.uses.push_back({edge, {face, out.edges[edge].v0 == a ? 1.0f : -1.0f}});
        }
    }
}

/// How often faces run an edge v0 -> v1.
std::uint32_t forwardUses(const Topology& topology, const Topology::Edge& edge)
{
    std::uint32_t forward = 0;
    for (std::uint32_t i = 0; i < edge.useCount; ++i)
        forward += topology.uses[edge.firstUse + i].sign > 0.0f;
    return forward;
}

/// Of the mesh as a whole: clusters that touch do not share an edge any more.
void judgeMesh(const Faces& faces, Topology& topology)
{
    topology.orientable = true;
    for (const Topology::Edge& edge : topology.edges) {
        const std::uint32_t forward = forwardUses(topology, edge);
        topology.orientable = topology.orientable && forward <= 1 && edge.useCount - forward <= 1;
        topology.crowded = topology.crowded || edge.useCount > 2;
        topology.borderEdges += edge.useCount == 1;
    }
    topology.looseFaces = static_cast<std::uint32_t>(faces.loose.size());
    topology.manifold = faces.loose.empty();
    for (const auto vertex : faces.mesh.vertices())
        topology.manifold = topology.manifold && faces.mesh.is_manifold(vertex);
}

void judgeClusters(Topology& topology)
{
    for (Topology::Cluster& cluster : topology.clusters) {
        const std::span<const Topology::Edge> edges = edgesOf(topology, cluster);
        cluster.watertight = std::all_of(edges.begin(), edges.end(), [&](const Topology::Edge& edge) {
            return 2 * forwardUses(topology, edge) == edge.useCount;
        });
    }
    topology.whole.edgeCount = static_cast<std::uint32_t>(topology.edges.size());
    topology.whole.faceCount = static_cast<std::uint32_t>(topology.faceVerts.size() / 3);
}

/// A face shows half of its area on average over directions (Cauchy); of a solid half of the faces are turned away.
double meanArea(const Topology& topology, const Topology::Cluster& cluster)
{
    double doubled = 0.0; // a normal's length is twice the area
    for (std::uint32_t place = cluster.firstFace; place < cluster.firstFace + cluster.faceCount; ++place)
        doubled += static_cast<double>(glm::length(glm::vec3(topology.facePlanes[topology.faceAt(place)])));
    return 0.25 * doubled * (cluster.closed ? 0.5 : 1.0);
}

void noteSides(Topology& topology, std::span<const glm::vec3> positions)
{
    double allCount = 0.0, allLength = 0.0, allArea = 0.0;
    for (Topology::Cluster& cluster : topology.clusters) {
        const double area = meanArea(topology, cluster);
        cluster.meanArea = static_cast<float>(area);
        allArea += area;
        double count = 0.0, length = 0.0;
        for (const Topology::Edge& edge : edgesOf(topology, cluster)) {
            const double sides = meanSides(topology, edge, cluster.closed);
            count += sides;
            length += sides * static_cast<double>(glm::distance(positions[edge.v0], positions[edge.v1]));
        }
        cluster.meanSides = static_cast<float>(count);
        cluster.meanSideLength = static_cast<float>(length);
        allCount += count;
        allLength += length;
    }
    topology.whole.meanSides = static_cast<float>(allCount);
    topology.whole.meanSideLength = static_cast<float>(allLength);
    topology.whole.meanArea = static_cast<float>(allArea);
}

} // namespace

/// A plane with a random normal parts the normals of two faces with the probability angle
/// / pi: so often does a distant light see one from the front and the other from behind. A side of a closed mesh is
/// drawn once, of an open one twice, a border's once whatever the light; of more than two uses half are taken.
double meanSides(const Topology& topology, const Topology::Edge& edge, bool closed)
{
    constexpr double kPi = 3.14159265358979323846;
    if (edge.useCount != 2) return 0.5 * (edge.useCount + edge.useCount % 2);
    const Topology::EdgeUse &one = topology.uses[edge.firstUse], &other = topology.uses[edge.firstUse + 1];
    const glm::dvec3 a(topology.facePlanes[one.face]), b(topology.facePlanes[other.face]);
    const double lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
    if (lengths == 0.0) return 0.0;                           // faces no light
    const double agree = one.sign == other.sign ? -1.0 : 1.0; // both running it the same way: one is flipped
    const double angle = std::acos(std::clamp(agree * glm::dot(a, b) / lengths, -1.0, 1.0));
    return (closed ? 1.0 : 2.0) * angle / kPi;
}

std::vector<std::uint32_t> weldVertices(std::span<const glm::vec3> positions, std::span<const std::uint32_t> before)
{
    std::vector<std::uint32_t> welded(positions.size());
    IdTable table(positions.size());
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const Corners at = bitsOf(positions[i]);
        const auto group = [&](std::uint32_t vertex) { return before.empty() ? 0 : before[vertex]; };
        // Many that lie at one point may be of different groups: the key tells these apart as well.
        const Corners key{at[0] ^ group(i), at[1], at[2]};
        welded[i] = table.findOrAdd(
            key, i, [&](std::uint32_t other) { return bitsOf(positions[other]) == at && group(other) == group(i); });
    }
    return welded;
}

Topology buildTopology(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    return buildTopology(positions, indices, weldVertices(positions));
}

Topology buildTopology(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                       std::span<const std::uint32_t> welded)
{
    Topology topology;
    topology.faceVerts.resize(indices.size());
    std::transform(indices.begin(), indices.end(), topology.faceVerts.begin(),
                   [&](std::uint32_t index) { return welded[index]; });

    Faces faces;
    addFaces(faces, topology.faceVerts, positions.size());
    Collector collector;
    collectHalfEdges(faces, collector);
    collectLoose(faces, topology.faceVerts, collector);
    collector.finish(topology);
    judgeMesh(faces, topology);
    updatePlanes(topology, positions);
    makeClusters(topology, positions);
    judgeClusters(topology);
    judgeOrientation(topology, positions);
    updateBounds(topology, positions);
    noteSides(topology, positions);
    return topology;
}
#endif

} // namespace gnomon
