#include "algorithms/volumes/volume_list.hpp"

#include <algorithm>

#include "algorithms/volumes/mesh_volumes.hpp"
#include "algorithms/volumes/silhouette.hpp"

namespace gnomon {

namespace {

// Edges or faces a piece: a few microseconds of work, against about one to hand it to a thread.
constexpr std::uint32_t kPieceSize = 8192;

// On the device every piece is a dispatch, so that a volume has one. A mesh of more edges would fit no buffer.
constexpr std::uint32_t kDevicePieceSize = 1u << 28;

// Of a side, and of a near and a far cap together. Every piece starts at a multiple of it, so that a shader that reads
// the list (penumbra_wedges) knows from an index where its side starts.
constexpr std::uint32_t kIndicesPerSide = 6;

/// Everything the building pass needs, in the frame's arena.
struct ListBuild {
    VolumeList list;
    ListKind kind = ListKind::sides;
    std::uint32_t pieceSize = kPieceSize;
    const LightView* light = nullptr;
    std::span<const VolumePiece> facePieces; ///< `first` and `count` are faces.
    std::uint32_t faceCount = 0;             ///< Bytes of scratch.
    std::uint32_t casterCount = 0;
};

std::uint32_t pieceCount(std::size_t items, std::uint32_t pieceSize = kPieceSize)
{
    return static_cast<std::uint32_t>((items + pieceSize - 1) / pieceSize);
}

std::uint32_t itemCount(const Topology::Cluster& cluster, ListKind kind)
{
    return kind == ListKind::sides ? cluster.edgeCount : cluster.faceCount;
}
std::uint32_t firstItem(const Topology::Cluster& cluster, ListKind kind)
{
    return kind == ListKind::sides ? cluster.firstEdge : cluster.firstFace;
}

/// Where the first piece starts, in indices: behind the commands.
std::uint32_t firstIndex(std::uint32_t pieces)
{
    const std::uint32_t commands = pieces * static_cast<std::uint32_t>(sizeof(VkDrawIndexedIndirectCommand) / 4);
    return (commands + kIndicesPerSide - 1) / kIndicesPerSide * kIndicesPerSide;
}

std::uint32_t indexCapacity(const Topology& topology, const Topology::Cluster& cluster, ListKind kind,
                            std::uint32_t first, std::uint32_t count)
{
    return kind == ListKind::sides ? sideCapacity(topology, cluster, first, count) : capCapacity(count);
}

/// At least: whatever is cut.
VkDeviceSize listBytes(std::span<const Caster* const> casters, ListKind kind, bool (*listed)(const Caster&))
{
    std::uint32_t pieces = 0;
    VkDeviceSize indices = 0;
    for (const Caster* caster : casters) {
        if (!listed(*caster)) continue;
        const Topology& topology = topologyOf(*caster->mesh);
        for (const Topology::Cluster& cluster : topology.clusters)
            pieces += pieceCount(itemCount(cluster, kind));
        indices += indexCapacity(topology, topology.whole, kind, 0, itemCount(topology.whole, kind));
    }
    return pieces ? 4 * (firstIndex(pieces) + indices) : 0;
}

/// Calls visit(caster) with the casters of the volumes, once for volumes of one that follow each other.
template <typename Visit>
void forCasters(std::span<const VolumeSource> volumes, const Visit& visit)
{
    const Caster* last = nullptr;
    for (const VolumeSource& volume : volumes)
        if (volume.caster != last) visit(*(last = volume.caster));
}

/// Pieces of all faces of the volumes' casters: which way they face is found for whole casters.
void layOutFaces(FrameArena& arena, std::span<const VolumeSource> volumes, ListBuild& build)
{
    std::uint32_t count = 0;
    forCasters(volumes, [&](const Caster& caster) {
        count += pieceCount(topologyOf(*caster.mesh).facePlanes.size());
        ++build.casterCount;
    });
    const std::span<VolumePiece> pieces = arena.array<VolumePiece>(count);
    std::size_t piece = 0;
    forCasters(volumes, [&](const Caster& caster) {
        const auto faces = static_cast<std::uint32_t>(topologyOf(*caster.mesh).facePlanes.size());
        for (std::uint32_t first = 0; first < faces; first += kPieceSize)
            pieces[piece++] = {{&caster, 0}, first, std::min(kPieceSize, faces - first), 0, build.faceCount};
        build.faceCount += faces;
    });
    build.facePieces = pieces;
}

/// Cuts the volumes into pieces and lays out the buffer. @return its size in indices; 0: nothing to build.
VkDeviceSize layOut(FrameArena& arena, std::span<const VolumeSource> volumes, ListBuild& build)
{
    layOutFaces(arena, volumes, build);
    std::uint32_t pieces = 0;
    for (const VolumeSource& volume : volumes)
        pieces += pieceCount(itemCount(volume.shape(), build.kind), build.pieceSize);
    const std::span<VolumePiece> list = arena.array<VolumePiece>(pieces);
    VkDeviceSize next = firstIndex(pieces);
    std::size_t piece = 0;
    std::uint32_t facingOffset = 0;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        const VolumeSource& volume = volumes[i];
        const Topology& topology = volume.topology();
        const Topology::Cluster& cluster = volume.shape();
        const std::uint32_t begin = firstItem(cluster, build.kind), end = begin + itemCount(cluster, build.kind);
        for (std::uint32_t first = begin; first < end; first += build.pieceSize) {
            const std::uint32_t count = std::min(build.pieceSize, end - first);
            list[piece++] = {volume, first, count, static_cast<std::uint32_t>(next), facingOffset};
            next += indexCapacity(topology, cluster, build.kind, first, count);
        }
        if (i + 1 < volumes.size() && volumes[i + 1].caster != volume.caster)
            facingOffset += static_cast<std::uint32_t>(topology.facePlanes.size());
    }
    build.list.pieces = list;
    return pieces ? next : 0;
}

/// Of those that lists hold. What the host draws is in none, and is another caster in every frame unless it is static.
std::uint64_t listedStamp(std::span<const Caster* const> casters)
{
    Stamp stamp;
    for (const Caster* caster : casters)
        if (castsVolume(*caster)) stamp.add(*caster);
    return stamp.value();
}

void run(const ListBuild& build, HostContext& host)
{
    const std::span<std::uint8_t> facing = host.arena->array<std::uint8_t>(build.faceCount);
    host.jobs->parallelFor(build.facePieces.size(), 4, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        for (const VolumePiece& piece : build.facePieces.subspan(begin, end - begin)) {
            const Caster& caster = *piece.source.caster;
            const gpu::FaceLight light = lightInObjectSpace(*build.light, caster);
            const auto out = facing.subspan(piece.facingOffset + piece.first, piece.count);
            findFacing(*caster.mesh->topology, light, piece.first, out);
            if (light.touch > 0.0f && piece.source.cluster != VolumeSource::kWhole)
                faceByCluster(*caster.mesh->topology, caster.mirrored, piece.first, out);
        }
    });

    const std::span<std::uint32_t> out = host.write<std::uint32_t>(build.list.buffer);
    const auto commands = host.write<VkDrawIndexedIndirectCommand>(build.list.buffer);
    host.jobs->parallelFor(build.list.pieces.size(), 4, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const VolumePiece& piece = build.list.pieces[i];
            const Caster& caster = *piece.source.caster;
            const Topology& topology = *caster.mesh->topology;
            const Topology::Cluster& cluster = piece.source.shape();
            const bool capsClosed = cluster.closed && !piece.source.bothSides;
            const auto faces =
                std::span<const std::uint8_t>(facing).subspan(piece.facingOffset, topology.facePlanes.size());
            std::uint32_t* indices = out.data() + piece.firstIndex;
            const std::uint32_t count =
                build.kind == ListKind::sides
                    ? writeSides(topology, cluster, faces, piece.first, piece.count, indices)
                    : writeCaps(topology, capsClosed, faces, caster.mirrored, piece.first, piece.count, indices);
            commands[i] = {.indexCount = count, .instanceCount = 1, .firstIndex = piece.firstIndex};
        }
    });
    for (std::uint32_t i = 0; i < build.casterCount; ++i)
        host.countIndexList();
}

VolumeList declareList(PassBuilder& passes, const ShadowTask& task, std::span<const VolumeSource> volumes,
                       ListKind kind, Scope scope, std::uint32_t variant, std::uint64_t stamp,
                       const MeshVolumePipelines* device = nullptr)
{
    ListBuild* build = passes.arena().make<ListBuild>();
    build->kind = kind;
    if (device) build->pieceSize = kDevicePieceSize;
    build->light = task.light;
    const VkDeviceSize size = layOut(passes.arena(), volumes, *build);
    if (size == 0) return {};
    if (size > UINT32_MAX) { // commands say where a piece begins in 32 bits
        passes.fail({GN_ERROR_TOO_MANY, "VolumeIndices",
                     "the casters in range need " + std::to_string(size) + " indices, above 4294967295"});
        return {};
    }

    const bool sides = kind == ListKind::sides;
    // Faces: some topology may have come late.
    stamp = Stamp().add(stamp).add(task.light->revision).add(std::uint64_t{build->faceCount}).value();
    if (device) {
        build->list.buffer = declareFound(passes, *task.light, *device, kind, build->list.pieces,
                                          {.name = sides ? "volumes.mesh_sides" : "volumes.mesh_caps",
                                           .scope = scope,
                                           .size = 4 * size,
                                           .variant = variant},
                                          stamp);
        return build->list;
    }
    const KeptList list = passes.keptList(
        BufferInfo{
            .name = sides ? "volumes.sides" : "volumes.caps", .scope = scope, .size = 4 * size, .variant = variant},
        stamp);
    build->list.buffer = list.buffer;
    if (!list.due) {
        passes.kept();
        return build->list;
    }
    passes.prepare(sides ? "volumes.silhouettes" : "volumes.caps", scope, variant)
        .writes(build->list.buffer)
        .run([build](HostContext& host) { run(*build, host); });
    return build->list;
}

// --- which meshes are cut ---

// Clusters of a light's static casters, and as many of its moving ones. A cluster takes 4 us to choose and draw on a
// software device; of 100 trees of 256 clusters each every one had its own, 242 ms became 338.
constexpr std::uint32_t kMostCut = 1024;

struct CutCandidate {
    std::uint32_t index = 0, clusters = 0;
    bool holdsLight = false;
    float size = 0.0f; ///< Surface of the bounds, square metres.
};

std::uint32_t clustersOf(const Caster& caster)
{
    const std::size_t count = castsVolume(caster) ? caster.mesh->topology->clusters.size() : 1;
    return count > 1 ? static_cast<std::uint32_t>(count) : 0;
}

/// For every caster whether its mesh is cut into clusters.
std::span<const bool> chooseCut(FrameArena& arena, std::span<const Caster* const> casters, const LightView& light)
{
    const std::span<bool> cut = arena.array<bool>(casters.size());
    std::uint32_t all = 0;
    std::size_t count = 0;
    for (const Caster* caster : casters) {
        all += clustersOf(*caster);
        count += clustersOf(*caster) > 0;
    }
    std::fill(cut.begin(), cut.end(), all <= kMostCut);
    if (all <= kMostCut) return cut;
    const std::span<CutCandidate> candidates = arena.array<CutCandidate>(count);
    count = 0;
    for (std::uint32_t i = 0; i < casters.size(); ++i) {
        const std::uint32_t clusters = clustersOf(*casters[i]);
        if (clusters == 0) continue;
        const Aabb& box = casters[i]->bounds;
        const glm::vec3 size = box.upper - box.lower;
        candidates[count++] = {i, clusters, holdsLight(box, light),
                               size.x * size.y + size.y * size.z + size.z * size.x};
    }
    std::sort(candidates.begin(), candidates.end(), [](const CutCandidate& a, const CutCandidate& b) {
        if (a.holdsLight != b.holdsLight) return a.holdsLight;
        return a.size != b.size ? a.size > b.size : a.index < b.index;
    });
    std::uint32_t left = kMostCut;
    for (const CutCandidate& candidate : candidates) {
        if (candidate.clusters > left) continue;
        left -= candidate.clusters;
        cut[candidate.index] = true;
    }
    return cut;
}

} // namespace

Aabb VolumeSource::bounds() const
{
    if (cluster == kWhole || caster->mesh->topology->clusters.size() == 1) return caster->bounds;
    return transformed(shape().bounds, caster->basis, caster->translation);
}

std::size_t mostVolumes(std::span<const Caster* const> casters)
{
    std::size_t clusters = 0;
    for (const Caster* caster : casters)
        clusters += castsVolume(*caster)           ? caster->mesh->topology->clusters.size()
                    : castsByConnectivity(*caster) ? 1
                                                   : 0;
    return std::min<std::size_t>(clusters, casters.size() + 2 * kMostCut); // of statics and of dynamic casters
}

std::span<const VolumeSource> volumesOf(FrameArena& arena, std::span<const Caster* const> casters,
                                        const LightView& light)
{
    const std::span<const bool> cut = chooseCut(arena, casters, light);
    const std::span<VolumeSource> volumes = arena.array<VolumeSource>(mostVolumes(casters));
    std::size_t count = 0;
    for (std::size_t i = 0; i < casters.size(); ++i) {
        if (!castsVolume(*casters[i])) continue;
        const auto clusters = static_cast<std::uint32_t>(casters[i]->mesh->topology->clusters.size());
        if (clusters > 1 && !cut[i]) {
            volumes[count++] = {casters[i], VolumeSource::kWhole};
            continue;
        }
        for (std::uint32_t cluster = 0; cluster < clusters; ++cluster)
            volumes[count++] = {casters[i], cluster};
    }
    return volumes.first(count);
}

VkDeviceSize sidesBytes(std::span<const Caster* const> casters, bool (*listed)(const Caster&))
{
    return listBytes(casters, ListKind::sides, listed);
}

VkDeviceSize capsBytes(std::span<const Caster* const> casters, bool (*listed)(const Caster&))
{
    return listBytes(casters, ListKind::caps, listed);
}

VolumeList declareSides(PassBuilder& passes, const ShadowTask& task, bool statics, const MeshVolumePipelines* device)
{
    const std::span<const Caster* const> casters = statics ? task.casters->statics : task.casters->dynamics;
    const std::uint64_t stamp = statics ? task.casters->staticStamp : listedStamp(casters);
    return declareList(passes, task, volumesOf(passes.arena(), casters, *task.light), ListKind::sides, Scope::light,
                       statics ? 0 : 1, stamp, device);
}

VolumeList declareMeshSides(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& device)
{
    const std::span<VolumeSource> volumes = passes.arena().array<VolumeSource>(task.casters->all.size());
    std::size_t count = 0;
    Stamp stamp;
    for (const Caster* caster : task.casters->all) {
        if (!castsByConnectivity(*caster)) continue;
        volumes[count++] = {caster, VolumeSource::kWhole};
        stamp.add(*caster);
    }
    return declareList(passes, task, volumes.first(count), ListKind::sides, Scope::light, kMeshVariant, stamp.value(),
                       &device);
}

// Variants 0 and 1 are all static and all moving casters.
constexpr std::uint32_t kChosenVariant = 2;

VolumeList declareChosenSides(PassBuilder& passes, const ShadowTask& task, const VolumeChoice& choice)
{
    return declareList(passes, task, choice.volumes, ListKind::sides, Scope::light, kChosenVariant + choice.variant,
                       choice.stamp);
}

VolumeList declareChosenCaps(PassBuilder& passes, const ShadowTask& task, const VolumeChoice& choice)
{
    return declareList(passes, task, choice.volumes, ListKind::caps, Scope::light, kChosenVariant + choice.variant,
                       choice.stamp);
}

VolumeList declareCaps(PassBuilder& passes, const ShadowTask& task, std::span<const VolumeSource> volumes,
                       std::uint32_t variant, const MeshVolumePipelines* device)
{
    Stamp stamp;
    for (const VolumeSource& volume : volumes)
        stamp.add(volume.caster->revision).add(std::uint64_t{volume.cluster} << 1 | (volume.bothSides ? 1 : 0));
    return declareList(passes, task, volumes, ListKind::caps, Scope::task, variant, stamp.value(), device);
}

} // namespace gnomon
