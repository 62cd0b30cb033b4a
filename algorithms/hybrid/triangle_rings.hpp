#pragma once
// The triangles around a triangle, for meshes whose shape stands still.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "runtime/scene/scene_view.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon {

/// Faces by welded vertex; with them the rings of a face: those that share an edge with it, those that share a vertex.
/// Neighbours over an edge of more than two faces all count.
class TriangleRings {
public:
    void build(const Topology& topology);
    std::size_t memoryBytes() const { return (first_.capacity() + faces_.capacity()) * sizeof(std::uint32_t); }

    /// Calls `visit(neighbour)` for the faces that share `shared` or more vertices with the face (2: an edge, 1: any),
    /// each once, not the face itself; at most kMostAround around each vertex. Stops when it returns true, and says so.
    template <typename Visit>
    bool around(const Topology& topology, std::uint32_t face, int shared, Visit&& visit) const;

    /// Faces asked about around a vertex: the hub of a fan of hundreds would cost more than a ray. Meshes of subdivided
    /// surfaces have 5 to 7; what is left out is not known to block, no more.
    static constexpr std::uint32_t kMostAround = 24;

private:
    std::vector<std::uint32_t> first_; ///< Of a vertex, into `faces_`; one more than vertices.
    std::vector<std::uint32_t> faces_;
};

template <typename Visit>
bool TriangleRings::around(const Topology& topology, std::uint32_t face, int shared, Visit&& visit) const
{
    const std::uint32_t* own = topology.faceVerts.data() + std::size_t{3} * face;
    for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t begin = first_[own[corner]], end = first_[own[corner] + 1];
        for (std::uint32_t i = begin; i < end && i - begin < kMostAround; ++i) {
            const std::uint32_t other = faces_[i];
            if (other == face) continue;
            const std::uint32_t* theirs = topology.faceVerts.data() + std::size_t{3} * other;
            int common = 0;
            bool seen = false; // around an earlier corner
            for (int c = 0; c < 3; ++c) {
                if (own[c] != theirs[0] && own[c] != theirs[1] && own[c] != theirs[2]) continue;
                ++common;
                seen = seen || c < corner;
            }
            if (!seen && common >= shared && visit(other)) return true;
        }
    }
    return false;
}

/// The rings of meshes, made once each. A mesh whose positions were ever rewritten has none: it is taken to go on
/// deforming (Moderno, 3.5), and rings would be followed in a map of another shape.
class RingsCache {
public:
    struct Entry {
        std::uint64_t revision = 0, used = 0; ///< `used` in this frame.
        bool deforms = false, built = false;
        TriangleRings rings;
    };
    /// Entries that find() gave in an earlier frame may go from now on.
    void begin(std::uint64_t frame) { frame_ = frame; }
    /// The mesh's entry, null where there are to be no rings. To be built (by whoever holds it) while `built` is false.
    /// It stays until the next begin() at least.
    Entry* find(const MeshView& mesh);
    std::size_t size() const { return entries_.size(); }

private:
    std::unordered_map<std::uint32_t, std::unique_ptr<Entry>> entries_; ///< By MeshView::id.
    std::uint64_t frame_ = 0;
};

} // namespace gnomon
