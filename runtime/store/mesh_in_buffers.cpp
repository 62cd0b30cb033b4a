#include <cstring>

#include "runtime/store/buffer_mesh.hpp"
#include "runtime/vk/structures.hpp"

namespace gnomon {

std::shared_ptr<MeshRevision> MeshBuilder::rewriteInBuffers(std::shared_ptr<BufferMesh> mesh, const Aabb& bounds) const
{
    auto revision = std::make_shared<MeshRevision>();
    revision->identity = mesh->identity;
    MeshView& view = revision->bare;
    view.name = mesh->identity->name.c_str();
    view.id = mesh->identity->id;
    view.bounds = bounds;
    view.edgeSpan = bounds.upper - bounds.lower; // no edge is longer
    view.vertexBuffer = mesh->vertices.get().buffer;
    view.indexBuffer = mesh->indices.get().buffer;
    view.revision = revisions_.fetch_add(1, std::memory_order_relaxed) + 1;
    view.turned = mesh->layout.turned;
    view.noCpuCopy = mesh->layout.noCpuCopy;
    revision->connectivity = mesh->connectivity;
    if (const MeshConnectivity* known = revision->connectivity.get()) {
        view.connectivity = known->topology.get();
        view.connectivityRevision = known->revision;
    }
    view.closed = view.connectivity ? view.connectivity->closed : mesh->layout.closed;
    view.gpuTriangles = mesh->layout.indexCount / 3;
    view.gpuPositions = mesh->layout.positionCount;
    view.vertexAddress = mesh->vertices.get().address;
    view.indexAddress = mesh->indices.get().address;
    view.faces = mesh->faces;
    revision->inBuffers = std::move(mesh);
    revision->shown = &view;
    return revision;
}

Result<std::shared_ptr<MeshRevision>> MeshBuilder::createInBuffers(BufferMeshInput input) const
{
    auto mesh = std::make_shared<BufferMesh>();
    mesh->layout = input.layout;
    mesh->identity = std::make_shared<MeshIdentity>();
    mesh->identity->name = std::move(input.name);
    mesh->identity->id = meshes_.fetch_add(1, std::memory_order_relaxed) + 1;
    mesh->identity->positionCount = input.layout.positionCount;
    mesh->identity->turned = input.layout.turned;
    mesh->faces = faces_.fetch_add(1, std::memory_order_relaxed) + 1;

    constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    const VkBufferUsageFlags read =
        kStorage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | (vk_.rayQuery() ? kBuildInput : VkBufferUsageFlags{0});
    struct Wanted {
        OwnedBuffer* to;
        VkDeviceSize size;
        VkBufferUsageFlags usage;
    };
    for (const Wanted& wanted : {Wanted{&mesh->vertices, sizeof(glm::vec3) * VkDeviceSize{input.layout.positionCount},
                                        read | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT},
                                 Wanted{&mesh->indices, sizeof(std::uint32_t) * VkDeviceSize{input.layout.indexCount},
                                        read | VK_BUFFER_USAGE_INDEX_BUFFER_BIT}}) {
        const Result<GpuBuffer> made =
            memory_.createBuffer(wanted.size, wanted.usage, MemoryUse::device, mesh->identity->name.c_str());
        if (!made) return made.error();
        *wanted.to = OwnedBuffer(memory_, *made);
    }
    Result<OwnedBuffer> found = findings(sizeof(MeshFindings), mesh->identity->name);
    if (!found) return found.error();
    mesh->findings = std::move(*found);
    mesh->bounds = input.bounds;
    return rewriteInBuffers(std::move(mesh), input.bounds);
}

Result<OwnedBuffer> MeshBuilder::readback(VkDeviceSize size, const std::string& name) const
{
    const Result<GpuBuffer> made =
        memory_.createBuffer(size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback, name.c_str());
    if (!made) return made.error();
    return OwnedBuffer(memory_, *made);
}

Result<OwnedBuffer> MeshBuilder::findings(VkDeviceSize size, const std::string& name) const
{
    const Result<GpuBuffer> made =
        memory_.createBuffer(size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::readback, name.c_str());
    if (!made) return made.error();
    std::memset(made->mapped, 0xff, size);
    return OwnedBuffer(memory_, *made);
}

std::uint32_t MeshConnectivity::firstApart() const noexcept
{
    std::uint32_t vertex = 0;
    std::memcpy(&vertex, watched.get().mapped, sizeof vertex);
    return vertex;
}

Result<std::shared_ptr<MeshRevision>> MeshBuilder::copied(const MeshRevision& of, const std::byte* content,
                                                          std::vector<MeshUpload>& uploads) const
{
    BufferMesh& mesh = *of.inBuffers;
    const std::size_t bytes = sizeof(glm::vec3) * std::size_t{mesh.layout.positionCount};
    if (!mesh.identity->given) { // indices never change
        std::vector<std::uint32_t> given(mesh.layout.indexCount);
        std::memcpy(given.data(), content + bytes, sizeof(std::uint32_t) * given.size());
        mesh.identity->given = std::make_shared<const std::vector<std::uint32_t>>(std::move(given));
    }
    auto revision = std::make_shared<MeshRevision>();
    revision->identity = mesh.identity;
    revision->inBuffers = of.inBuffers;
    revision->faces = mesh.copiedFaces;
    revision->positions.resize(mesh.layout.positionCount + kPositionPadding);
    std::memcpy(revision->positions.data(), content, bytes);
    revision->bare.revision = of.bare.revision; // the same positions
    return finish(std::move(revision), false, uploads);
}

#ifdef GNOMON_WITH_OPENMESH
Result<std::shared_ptr<const MeshConnectivity>> MeshBuilder::connected(const MeshRevision& of, const std::byte* content,
                                                                       const MeshRevision* made) const
{
    const MeshIdentity& identity = *of.identity;
    std::vector<glm::vec3> positions(identity.positionCount);
    std::memcpy(positions.data(), content, sizeof(glm::vec3) * positions.size());
    std::vector<std::uint32_t> before;
    if (const MeshConnectivity* old = of.inBuffers->connectivity.get()) {
        before = old->welded;
        // It may be back where it was. Told apart by its number, no vertex is found twice.
        if (const std::uint32_t apart = old->firstApart(); apart < before.size()) before[apart] = apart;
    }
    auto connectivity = std::make_shared<MeshConnectivity>();
    connectivity->welded = weldVertices(positions, before);
    std::vector<std::uint32_t> faces;
    for (std::size_t i = 0; i < identity.given->size(); i += 3) {
        const std::uint32_t* corner = identity.given->data() + i;
        const std::uint32_t a = connectivity->welded[corner[0]], b = connectivity->welded[corner[1]],
                            c = connectivity->welded[corner[2]];
        if (a != b && b != c && c != a) faces.insert(faces.end(), corner, corner + 3);
    }
    const bool same = made && made->topology && before.empty() && faces == *made->faces->indices;
    connectivity->topology =
        same ? made->topology : std::make_shared<const Topology>(buildTopology(positions, faces, connectivity->welded));

    constexpr std::uint32_t kNone = UINT32_MAX;
    const VkDeviceSize size = sizeof kNone * (1 + connectivity->welded.size());
    const Result<GpuBuffer> watched =
        memory_.createBuffer(size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::readback, identity.name.c_str());
    if (!watched) return watched.error();
    connectivity->watched = OwnedBuffer(memory_, *watched);
    std::memcpy(watched->mapped, &kNone, sizeof kNone);
    std::memcpy(watched->mapped + sizeof kNone, connectivity->welded.data(), size - sizeof kNone);
    connectivity->revision = revisions_.fetch_add(1, std::memory_order_relaxed) + 1;
    return std::shared_ptr<const MeshConnectivity>(std::move(connectivity));
}
#else
Result<std::shared_ptr<const MeshConnectivity>> MeshBuilder::connected(const MeshRevision&, const std::byte*,
                                                                       const MeshRevision*) const
{
    return std::shared_ptr<const MeshConnectivity>();
}
#endif

} // namespace gnomon
