#include "algorithms/volumes/volume_list.hpp"

#include "algorithms/common/caster_lists.hpp"
#include "algorithms/volumes/gpu_silhouettes.hpp"
#include "algorithms/volumes/silhouette.hpp"

namespace gnomon {

namespace {

// Edges or faces a piece: a few microseconds of work, against about one to hand it to a thread.
constexpr std::uint32_t kPieceSize = 8192;

// Of a side, and of a near and a far cap together. Every piece starts at a multiple of it, so that a shader that reads
// the list (penumbra_wedges) knows from an index where its side starts.
constexpr std::uint32_t kIndicesPerSide = 6;

enum class ListKind : std::uint8_t { sides, caps };

/// Everything the building pass needs, in the frame's arena.
struct ListBuild {
    VolumeList list;
    ListKind kind = ListKind::sides;
    const LightView* light = nullptr;
    std::span<const VolumePiece> facePieces; ///< `first` and `count` are faces.
    std::uint32_t faceCount = 0;             ///< Bytes of scratch.
    std::uint32_t casterCount = 0;
};

std::uint32_t pieceCount(std::size_t items)
{
    return static_cast<std::uint32_t>((items + kPieceSize - 1) / kPieceSize);
}

std::uint32_t itemCount(const Topology& topology, ListKind kind)
{
    return static_cast<std::uint32_t>(kind == ListKind::sides ? topology.edges.size() : topology.facePlanes.size());
}

/// Where the first piece starts, in indices: behind the commands.
std::uint32_t firstIndex(std::uint32_t pieces)
{
    const std::uint32_t commands = pieces * static_cast<std::uint32_t>(sizeof(VkDrawIndexedIndirectCommand) / 4);
    return (commands + kIndicesPerSide - 1) / kIndicesPerSide * kIndicesPerSide;
}

std::uint32_t indexCapacity(const Topology& topology, ListKind kind, std::uint32_t first, std::uint32_t count)
{
    return kind == ListKind::sides ? sideCapacity(topology, first, count) : capCapacity(count);
}

VkDeviceSize listBytes(std::span<const Caster* const> casters, ListKind kind)
{
    std::uint32_t pieces = 0;
    VkDeviceSize indices = 0;
    for (const Caster* caster : casters) {
        if (!castsVolume(*caster)) continue;
        const Topology& topology = *caster->mesh->topology;
        pieces += pieceCount(itemCount(topology, kind));
        indices += indexCapacity(topology, kind, 0, itemCount(topology, kind));
    }
    return pieces ? 4 * (firstIndex(pieces) + indices) : 0;
}

/// Cuts the casters into pieces and lays out the buffer. @return its size in indices; 0: nothing to build.
VkDeviceSize layOut(FrameArena& arena, std::span<const Caster* const> casters, ListBuild& build)
{
    std::uint32_t pieces = 0, facePieces = 0;
    for (const Caster* caster : casters) {
        if (!castsVolume(*caster)) continue;
        pieces += pieceCount(itemCount(*caster->mesh->topology, build.kind));
        facePieces += pieceCount(caster->mesh->topology->facePlanes.size());
        ++build.casterCount;
    }
    const std::span<VolumePiece> list = arena.array<VolumePiece>(pieces);
    const std::span<VolumePiece> faces = arena.array<VolumePiece>(facePieces);
    VkDeviceSize next = firstIndex(pieces);
    std::size_t piece = 0, facePiece = 0;
    for (const Caster* caster : casters) {
        if (!castsVolume(*caster)) continue;
        const Topology& topology = *caster->mesh->topology;
        const std::uint32_t items = itemCount(topology, build.kind);
        for (std::uint32_t first = 0; first < items; first += kPieceSize) {
            const std::uint32_t count = std::min(kPieceSize, items - first);
            list[piece++] = {caster, first, count, static_cast<std::uint32_t>(next), build.faceCount};
            next += indexCapacity(topology, build.kind, first, count);
        }
        const auto faceCount = static_cast<std::uint32_t>(topology.facePlanes.size());
        for (std::uint32_t first = 0; first < faceCount; first += kPieceSize)
            faces[facePiece++] = {caster, first, std::min(kPieceSize, faceCount - first), 0, build.faceCount};
        build.faceCount += faceCount;
    }
    build.list.pieces = list;
    build.facePieces = faces;
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
            const gpu::FaceLight light = lightInObjectSpace(*build.light, *piece.caster);
            findFacing(*piece.caster->mesh->topology, light, piece.first,
                       facing.subspan(piece.facingOffset + piece.first, piece.count));
        }
    });

    const std::span<std::uint32_t> out = host.write<std::uint32_t>(build.list.buffer);
    const auto commands = host.write<VkDrawIndexedIndirectCommand>(build.list.buffer);
    host.jobs->parallelFor(build.list.pieces.size(), 4, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const VolumePiece& piece = build.list.pieces[i];
            const Topology& topology = *piece.caster->mesh->topology;
            const auto faces =
                std::span<const std::uint8_t>(facing).subspan(piece.facingOffset, topology.facePlanes.size());
            std::uint32_t* indices = out.data() + piece.firstIndex;
            const std::uint32_t count =
                build.kind == ListKind::sides
                    ? writeSides(topology, faces, piece.first, piece.count, indices)
                    : writeCaps(topology, faces, piece.caster->mirrored, piece.first, piece.count, indices);
            commands[i] = {.indexCount = count, .instanceCount = 1, .firstIndex = piece.firstIndex};
        }
    });
    for (std::uint32_t i = 0; i < build.casterCount; ++i)
        host.countIndexList();
}

VolumeList declareList(PassBuilder& passes, const ShadowTask& task, std::span<const Caster* const> casters,
                       ListKind kind, Scope scope, std::uint32_t variant, std::uint64_t stamp,
                       const GpuSilhouettes* shader = nullptr)
{
    ListBuild* build = passes.arena().make<ListBuild>();
    build->kind = kind;
    build->light = task.light;
    const VkDeviceSize size = layOut(passes.arena(), casters, *build);
    if (size == 0) return {};
    if (size > UINT32_MAX) { // commands say where a piece begins in 32 bits
        passes.fail({GN_ERROR_TOO_MANY, "VolumeIndices",
                     "the casters in range need " + std::to_string(size) + " indices, above 4294967295"});
        return {};
    }

    const bool sides = kind == ListKind::sides;
    // Faces: some topology may have come late.
    stamp = Stamp().add(stamp).add(task.light->revision).add(std::uint64_t{build->faceCount}).value();
    if (shader) {
        build->list.buffer = declareGpuSides(passes, task, *shader, build->list.pieces,
                                             static_cast<std::uint32_t>(size), variant, stamp);
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

} // namespace

VkDeviceSize sidesBytes(std::span<const Caster* const> casters)
{
    return listBytes(casters, ListKind::sides);
}

VkDeviceSize capsBytes(std::span<const Caster* const> casters)
{
    return listBytes(casters, ListKind::caps);
}

VolumeList declareSides(PassBuilder& passes, const ShadowTask& task, bool statics, const GpuSilhouettes* shader)
{
    const std::span<const Caster* const> casters = statics ? task.casters->statics : task.casters->movings;
    const std::uint64_t stamp = statics ? task.casters->staticStamp : listedStamp(casters);
    return declareList(passes, task, casters, ListKind::sides, Scope::light, statics ? 0 : 1, stamp, shader);
}

// Variants 0 and 1 are all static and all moving casters.
constexpr std::uint32_t kChosenVariant = 2;

VolumeList declareChosenSides(PassBuilder& passes, const ShadowTask& task, const VolumeChoice& choice)
{
    return declareList(passes, task, choice.casters, ListKind::sides, Scope::light, kChosenVariant + choice.variant,
                       choice.stamp);
}

VolumeList declareChosenCaps(PassBuilder& passes, const ShadowTask& task, const VolumeChoice& choice)
{
    return declareList(passes, task, choice.casters, ListKind::caps, Scope::light, kChosenVariant + choice.variant,
                       choice.stamp);
}

VolumeList declareCaps(PassBuilder& passes, const ShadowTask& task, std::span<const Caster* const> casters,
                       std::uint32_t variant)
{
    Stamp stamp;
    for (const Caster* caster : casters)
        stamp.add(caster->revision);
    return declareList(passes, task, casters, ListKind::caps, Scope::task, variant, stamp.value());
}

} // namespace gnomon
