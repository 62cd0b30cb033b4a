#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/scene/aabb.hpp"
#include "runtime/scene/face_block.hpp"

namespace gnomon {

/// Planes of faces in object space, one after the other for whom it concerns and in blocks of a structure of arrays for
/// those that test many at once. Places behind the last face hold planes of zeros, which face no light.
class FacePlanes {
public:
    void resize(std::size_t count)
    {
        count_ = count;
        blocks_.assign((count + kBlockFaces - 1) / kBlockFaces, FaceBlock{});
    }
    std::size_t size() const noexcept { return count_; }

    /// xyz unnormalised face normal, w = -dot(normal, corner).
    glm::vec4 operator[](std::size_t face) const
    {
        const FaceBlock& block = blocks_[face / kBlockFaces];
        const std::size_t lane = face % kBlockFaces;
        return {block.x[lane], block.y[lane], block.z[lane], block.w[lane]};
    }
    void set(std::size_t face, const glm::vec4& plane)
    {
        FaceBlock& block = blocks_[face / kBlockFaces];
        const std::size_t lane = face % kBlockFaces;
        block.x[lane] = plane.x;
        block.y[lane] = plane.y;
        block.z[lane] = plane.z;
        block.w[lane] = plane.w;
    }
    const FaceBlock* blocks() const noexcept { return blocks_.data(); }

private:
    std::vector<FaceBlock> blocks_;
    std::size_t count_ = 0;
};

/// Connectivity of one mesh, made once: position-welded edges with the faces that use them.
///
/// Silhouettes follow from **signed multiplicities**: orient every face so that it looks towards the light, let each
/// use of an edge count +1 or -1 by its direction; the sum is 0 inside, +-1 at a border, +-2 at a silhouette, and may
/// be anything on non-manifold edges. Extruding every edge that often closes the volume whatever the mesh is like.
struct Topology {
    /// One use of an edge by a face.
    struct EdgeUse {
        std::uint32_t face;
        float sign; ///< +1 if the face runs v0 -> v1, -1 if v1 -> v0.
    };
    struct Edge {
        std::uint32_t v0, v1;   ///< Vertices, indices into the mesh's positions (representatives of welded ones).
        std::uint32_t firstUse; ///< Into `uses`.
        std::uint32_t useCount; ///< 1 border, 2 manifold, more: non-manifold.
    };

    /// Faces that hang together or lie side by side (mesh_clusters.hpp), and the edges between them. A building in one
    /// mesh has a volume for each of its clusters: lamps and the eye are within the bounds of the whole.
    struct Cluster {
        std::uint32_t firstEdge = 0, edgeCount = 0;
        std::uint32_t firstFace = 0, faceCount = 0; ///< Places, for faceAt().
        Aabb bounds;                                ///< Object space.
        bool watertight = false;                    ///< Every edge is used equally often in both directions: no holes.
        bool insideOut = false;                     ///< Some watertight shell of it is (inside_out.hpp).
        bool closed = false;                        ///< Watertight and not inside out: a solid.
        float meanSides = 0.0f;      ///< Sides of its volumes, on average over all directions of light; as built.
        float meanSideLength = 0.0f; ///< And the lengths of their edges together, object space.
        float meanArea = 0.0f; ///< Of its faces as a light sees them, hidden ones too, on average over directions.
    };

    std::vector<Edge> edges; ///< In the order of clusters, and `uses` in that of edges.
    std::vector<EdgeUse> uses;
    FacePlanes facePlanes;
    std::vector<std::uint32_t> faceVerts;    ///< Three per face: welded representatives, in the mesh's order.
    std::vector<Cluster> clusters;           ///< One at least.
    Cluster whole;                           ///< The mesh as if it were one.
    std::vector<std::uint8_t> clusterOfFace; ///< Empty: there is only one.
    std::vector<std::uint32_t> shellOfFace;  ///< Faces that hang together; empty: all do.
    std::uint32_t shellCount = 1;
    std::vector<std::uint32_t> facesInOrder; ///< In the order of clusters; empty: in the mesh's.
    bool closed = false;                     ///< All clusters are. Others cast with both sides of their triangles.
    bool orientable = false;                 ///< No two faces run an edge of the mesh the same way.
    bool crowded = false;                    ///< Some edge of the mesh has more than two faces.
    std::uint32_t borderEdges = 0;           ///< Edges of the mesh with one face.
    bool manifold = false;        ///< No edge has more than two faces, every vertex one fan (as OpenMesh sees it).
    std::uint32_t looseFaces = 0; ///< Faces OpenMesh refused (third face on an edge, flipped neighbour), kept here.

    /// The face at a place in the order of clusters.
    std::uint32_t faceAt(std::uint32_t place) const { return facesInOrder.empty() ? place : facesInOrder[place]; }
    const Cluster& clusterOf(std::uint32_t face) const
    {
        return clusters[clusterOfFace.empty() ? 0 : clusterOfFace[face]];
    }
};

inline std::span<const Topology::Edge> edgesOf(const Topology& topology, const Topology::Cluster& cluster)
{
    return std::span(topology.edges).subspan(cluster.firstEdge, cluster.edgeCount);
}

inline std::span<const Topology::EdgeUse> usesOf(const Topology& topology, const Topology::Edge& edge)
{
    return std::span(topology.uses).subspan(edge.firstUse, edge.useCount);
}

/// How often an edge is a side of a shadow volume, on average over all directions of light. @param closed its cluster
double meanSides(const Topology& topology, const Topology::Edge& edge, bool closed);

/// For every vertex the one that stands for it: the first with equal bits (-0 equals 0).
/// @param before the same of another pose, or empty: vertices that were apart there stay apart
std::vector<std::uint32_t> weldVertices(std::span<const glm::vec3> positions,
                                        std::span<const std::uint32_t> before = {});

/// Builds the topology of vertices that are welded so. Indices are in range. Nothing is printed, whatever the mesh is
/// like.
Topology buildTopology(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                       std::span<const std::uint32_t> welded);
/// The same with weldVertices() of these positions.
Topology buildTopology(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

/// Same connectivity, new positions: recomputes planes and bounds only.
void updatePositions(Topology& topology, std::span<const glm::vec3> positions);

} // namespace gnomon
