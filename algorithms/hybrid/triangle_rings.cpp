#include "algorithms/hybrid/triangle_rings.hpp"

#include <algorithm>

namespace gnomon {

namespace {
// Meshes not asked for in this many frames are forgotten when another one comes. The frame's own are in use.
constexpr std::uint64_t kForgetAfter = 300;
} // namespace

void TriangleRings::build(const Topology& topology)
{
    const std::span<const std::uint32_t> corners = topology.faceVerts;
    const std::uint32_t vertices = corners.empty() ? 0 : *std::max_element(corners.begin(), corners.end()) + 1;
    // Counting sort of the corners by vertex.
    first_.assign(std::size_t{vertices} + 1, 0);
    for (const std::uint32_t vertex : corners)
        ++first_[vertex + 1];
    for (std::size_t v = 0; v < vertices; ++v)
        first_[v + 1] += first_[v];
    faces_.resize(corners.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t corner = 0; corner < corners.size(); ++corner)
        faces_[next[corners[corner]]++] = static_cast<std::uint32_t>(corner / 3);
}

RingsCache::Entry* RingsCache::find(const MeshView& mesh)
{
    if (!mesh.topology) return nullptr;
    auto found = entries_.find(mesh.id);
    if (found == entries_.end()) {
        std::erase_if(entries_, [&](const auto& entry) { return entry.second->used + kForgetAfter < frame_; });
        found = entries_.emplace(mesh.id, std::make_unique<Entry>()).first;
        found->second->revision = mesh.revision;
    }
    Entry& entry = *found->second;
    entry.used = frame_;
    if (entry.revision != mesh.revision && !entry.deforms) {
        entry.deforms = true;
        entry.rings = {};
    }
    return entry.deforms ? nullptr : &entry;
}

} // namespace gnomon
