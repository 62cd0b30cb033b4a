#include "runtime/store/mesh_store.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "runtime/scene/long_edges.hpp"
#include "runtime/scene/mesh_chunks.hpp"
#include "runtime/vk/structures.hpp"

namespace gnomon {
namespace {

Aabb boundsOf(std::span<const Aabb> chunks)
{
    return std::accumulate(chunks.begin() + 1, chunks.end(), chunks.front(), unionOf);
}

#ifdef GNOMON_WITH_OPENMESH
/// The vertices that were one for `topology` still are.
bool weldsHold(const Topology& topology, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (positions[indices[i]] != positions[topology.faceVerts[i]]) return false;
    return true;
}

std::shared_ptr<const Topology> topologyOf(MeshFaces& faces, std::span<const glm::vec3> positions)
{
    const std::shared_ptr<const Topology> known = faces.connectivity();
    std::shared_ptr<Topology> topology;
    if (known && weldsHold(*known, positions, *faces.indices)) {
        topology = std::make_shared<Topology>(*known);
        updatePositions(*topology, positions);
    } else {
        topology = std::make_shared<Topology>(buildTopology(positions, *faces.indices));
    }
    faces.remember(topology);
    return topology;
}
#endif

} // namespace

#ifdef GNOMON_WITH_OPENMESH
constexpr bool kWithTopology = true;
#else
constexpr bool kWithTopology = false;
#endif

MeshBuilder::MeshBuilder(const DeviceTable& vk, DeviceMemory& memory, RayScene* rays, const Messages& messages,
                         bool background)
    : vk_(vk), memory_(memory), rays_(rays), messages_(messages),
      background_(background && (kWithTopology || rays || vk.rayQuery()))
{
}

Result<OwnedBuffer> MeshBuilder::upload(const void* data, VkDeviceSize size, VkBufferUsageFlags usage,
                                        const std::string& name, std::vector<MeshUpload>& uploads) const
{
    usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (vk_.rayQuery()) usage |= kBuildInput;
    Result<GpuBuffer> made = memory_.createBuffer(size, usage, MemoryUse::device, name.c_str());
    if (!made) return made.error();
    OwnedBuffer buffer(memory_, *made);
    if (made->mapped) {
        std::memcpy(made->mapped, data, size);
        return buffer;
    }
    Result<GpuBuffer> staging =
        memory_.createBuffer(size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload, name.c_str());
    if (!staging) return staging.error();
    uploads.push_back({.staging = OwnedBuffer(memory_, *staging), .target = made->buffer, .size = size, .owner = {}});
    std::memcpy(staging->mapped, data, size);
    return buffer;
}

Result<std::shared_ptr<MeshRevision>> MeshBuilder::create(MeshInput input, std::vector<MeshUpload>& uploads) const
{
    auto identity = std::make_shared<MeshIdentity>();
    identity->name = std::move(input.name);
    identity->id = meshes_.fetch_add(1, std::memory_order_relaxed) + 1;
    identity->turned = input.turned;
    identity->positionCount = static_cast<std::uint32_t>(input.positions.size() - kPositionPadding);
    identity->given = std::make_shared<const std::vector<std::uint32_t>>(std::move(input.indices));

    auto revision = std::make_shared<MeshRevision>();
    revision->identity = identity;
    revision->positions = std::move(input.positions);
    Result<std::shared_ptr<MeshRevision>> made = finish(std::move(revision), background_, uploads);
    if (!made) return made;
    const std::size_t removed = (identity->given->size() - (*made)->faces->indices->size()) / 3;
    if (removed)
        messages_.warn("MeshZeroAreaTriangles", identity->what() + " has " + std::to_string(removed) +
                                                    " triangles without area; they are left out");
    return made;
}

Result<std::shared_ptr<MeshRevision>> MeshBuilder::rewrite(const MeshRevision& old, std::vector<glm::vec3> positions,
                                                           std::vector<MeshUpload>& uploads) const
{
    auto revision = std::make_shared<MeshRevision>();
    revision->identity = old.identity;
    revision->faces = old.faces;
    revision->positions = std::move(positions);
    return finish(std::move(revision), background_, uploads);
}

/// Buffers, bounds and views of a revision that has identity and positions, and the faces of its predecessor if any.
Result<std::shared_ptr<MeshRevision>> MeshBuilder::finish(std::shared_ptr<MeshRevision> revision, bool inBackground,
                                                          std::vector<MeshUpload>& uploads) const
{
    MeshIdentity& identity = *revision->identity;
    const std::span<const glm::vec3> positions(revision->positions.data(), identity.positionCount);
    KeptTriangles kept = withoutZeroArea(positions, *identity.given);
    if (kept.indices.empty())
        return Error{GN_ERROR_EMPTY, "MeshEmpty", identity.what() + " has no triangle with an area"};
    const std::size_t before = uploads.size();
    if (!revision->faces || *revision->faces->indices != kept.indices) {
        auto faces = std::make_shared<MeshFaces>();
        faces->indices = kept.numbers.empty()
                             ? identity.given
                             : std::make_shared<const std::vector<std::uint32_t>>(std::move(kept.indices));
        faces->givenNumbers = std::move(kept.numbers);
        Result<OwnedBuffer> buffer = upload(faces->indices->data(), faces->indices->size() * sizeof(std::uint32_t),
                                            VK_BUFFER_USAGE_INDEX_BUFFER_BIT, identity.name, uploads);
        if (!buffer) return buffer.error();
        faces->buffer = std::move(*buffer);
        faces->id = faces_.fetch_add(1, std::memory_order_relaxed) + 1;
        revision->faces = std::move(faces);
    }
    for (std::size_t i = before; i < uploads.size(); ++i)
        uploads[i].owner = revision->faces;

    const std::size_t afterFaces = uploads.size();
    Result<OwnedBuffer> vertices =
        upload(positions.data(), positions.size_bytes(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, identity.name, uploads);
    if (!vertices) return vertices.error();
    revision->vertices = std::move(*vertices);
    for (std::size_t i = afterFaces; i < uploads.size(); ++i)
        uploads[i].owner = revision;

    MeshView& view = revision->bare;
    view.name = identity.name.c_str();
    view.id = identity.id;
    view.positions = positions;
    view.indices = *revision->faces->indices;
    view.givenNumbers = revision->faces->givenNumbers;
    revision->chunks = chunkBounds(positions, view.indices);
    view.chunks = revision->chunks;
    view.bounds = boundsOf(view.chunks);
    view.edgeSpan = edgeSpan(positions, view.indices);
    view.vertexBuffer = revision->vertices.get().buffer;
    view.indexBuffer = revision->faces->buffer.get().buffer;
    view.vertexAddress = revision->vertices.get().address;
    view.indexAddress = revision->faces->buffer.get().address;
    view.faces = revision->faces->id;
    view.turned = identity.turned;
    if (view.revision == 0) view.revision = revisions_.fetch_add(1, std::memory_order_relaxed) + 1;
    revision->shown = &view;

    revision->builder = this;
    revision->job.data = revision.get();
    revision->job.run = [](void* data) {
        MeshRevision& self = *static_cast<MeshRevision*>(data);
        self.builder->derive(self);
    };
    if (inBackground) {
        revision->job.finished.store(false, std::memory_order_relaxed);
    } else {
        derive(*revision);
        revision->shown = &revision->full;
    }
    return revision;
}

/// The job: topology and tree. Failing to get one is no failure of the mesh, which casts by other methods then.
void MeshBuilder::derive(MeshRevision& revision) const noexcept
{
    revision.full = revision.bare;
    if (revision.abandoned.load(std::memory_order_relaxed)) return;
    MeshView& view = revision.full;
    try {
#ifdef GNOMON_WITH_OPENMESH
        revision.topology = topologyOf(*revision.faces, view.positions);
        view.topology = revision.topology.get();
        view.closed = revision.topology->closed;
        view.insideOut = revision.topology->whole.insideOut;
        remarkOn(revision);
#endif
        if (rays_) revision.rays = rays_->build(view.positions, view.indices, &revision.faces->rays);
        view.rays = revision.rays.get();
        if (vk_.rayQuery()) view.longest = longestOf(view.positions, view.indices);
    } catch (const std::exception& failure) {
        try {
            messages_.warn("MeshNotPrepared",
                           revision.identity->what() + ": topology or ray-tracing tree failed: " + failure.what());
        } catch (...) { // no memory for the sentence either; the missing pointers speak for themselves
        }
    }
}

void MeshBuilder::remarkOn(const MeshRevision& revision) const
{
    const Topology& topology = *revision.topology;
    if (topology.closed && topology.manifold && topology.orientable) return;
    if (revision.identity->remarked.exchange(true)) return;
    const std::string open = "open: " + std::to_string(topology.borderEdges) + " border edges";
    const char* asItIs = topology.closed ? "; it casts as it is" : "; it casts with both sides of its triangles";
    const std::string what = revision.identity->what() + " is ";
    if (topology.whole.insideOut) { // rooms seen from within, and mistakes
        messages_.info(
            "MeshInsideOut",
            what +
                "inside out: it has a closed shell whose triangles go round the other way than frontFace says, seen "
                "from outside" +
                asItIs);
        return;
    }
    if (topology.manifold && topology.orientable) { // floors, leaves, cards: meant so as a rule
        messages_.info("MeshOpen", what + open + asItIs);
        return;
    }
    const char* fault = topology.crowded || topology.orientable
                            ? "no manifold surface"
                            : "a surface whose triangles disagree about the outside";
    messages_.warn("MeshNotManifold",
                   what + fault + (topology.borderEdges > 0 ? ", and " + open : std::string()) + asItIs);
}

} // namespace gnomon
