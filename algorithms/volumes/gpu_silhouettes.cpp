#include "algorithms/volumes/gpu_silhouettes.hpp"

#include <algorithm>
#include <cstring>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/mesh_numbers.hpp"
#include "algorithms/volumes/silhouette.hpp"

#include "shaders/volumes/silhouettes.h"
#include "shaders/volumes_silhouettes_comp.h"

namespace gnomon {

namespace {

static_assert(gpu::SILHOUETTE_BLOCK == kBlockFaces && sizeof(FaceBlock) == 4 * 4 * kBlockFaces);

constexpr std::uint32_t kBlockWords = 4 * kBlockFaces;
constexpr std::uint32_t kPieceWords = sizeof(gpu::SilhouettePiece) / 4;
// Vulkan promises no more workgroups in a row.
constexpr std::uint32_t kGroupsInRow = 65535;

/// Where a mesh's topology lies; casters of one mesh share it.
struct MeshPlace {
    const MeshView* mesh = nullptr;
    std::uint32_t edges = 0, uses = 0, planes = 0; ///< Words.
};

/// The buffer of topology; in the frame's arena.
struct Layout {
    std::span<const VolumePiece> pieces;
    std::span<gpu::SilhouettePiece> records;
    std::span<MeshPlace> meshes;
    const LightView* light = nullptr;
    MeshNumbers* numbers = nullptr; ///< Of meshes.
    std::uint32_t groups = 0, words = 0;
    BufferId topology, lights;
};

std::uint32_t wordsOf(std::size_t count)
{
    return static_cast<std::uint32_t>(count);
}

/// The mesh's place, given one behind all others if it has none yet.
const MeshPlace& placeOf(const MeshView& mesh, Layout& layout)
{
    if (const std::uint32_t number = layout.numbers->of(mesh); number < layout.meshes.size())
        return layout.meshes[number];
    const Topology& topology = *mesh.topology;
    MeshPlace place{.mesh = &mesh, .edges = layout.words};
    place.uses = place.edges + gpu::EDGE_WORDS * wordsOf(topology.edges.size());
    // Blocks of planes begin with a cache line.
    place.planes = (place.uses + wordsOf(topology.uses.size()) + kBlockFaces - 1) / kBlockFaces * kBlockFaces;
    layout.words = place.planes + kBlockWords * wordsOf((topology.facePlanes.size() + kBlockFaces - 1) / kBlockFaces);
    layout.meshes = {layout.meshes.data(), layout.meshes.size() + 1};
    return layout.meshes.back() = place;
}

/// At least what layOut() makes of them, which lists a mesh once however many casters have it. In time of their number.
VkDeviceSize topologyBytes(std::span<const Caster* const> casters)
{
    VkDeviceSize words = 0;
    for (const Caster* caster : casters) {
        if (!castsVolume(*caster)) continue;
        const Topology& topology = *caster->mesh->topology;
        // Of long pieces, what they and their workgroups take is less than a word for 32 edges, and once the rest.
        words += topology.edges.size() / 32 + (kPieceWords + 2) * topology.clusters.size();
        words += gpu::EDGE_WORDS * topology.edges.size() + topology.uses.size();
        words += 4 * topology.facePlanes.size() + 2 * kBlockWords;
    }
    return 4 * words;
}

void layOut(FrameArena& arena, std::span<const VolumePiece> pieces, Layout& layout)
{
    layout.pieces = pieces;
    layout.records = arena.array<gpu::SilhouettePiece>(pieces.size());
    layout.meshes = arena.array<MeshPlace>(pieces.size()).first(0);
    layout.numbers = arena.make(MeshNumbers(arena, pieces.size()));
    for (const VolumePiece& piece : pieces)
        layout.groups += (piece.count + gpu::SILHOUETTE_GROUP - 1) / gpu::SILHOUETTE_GROUP;
    layout.words = layout.groups + kPieceWords * wordsOf(pieces.size());
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const VolumePiece& piece = pieces[i];
        const MeshPlace& place = placeOf(*piece.source.caster->mesh, layout);
        layout.records[i] = {.edges = place.edges + gpu::EDGE_WORDS * piece.first,
                             .edgeCount = piece.count,
                             .uses = place.uses,
                             .planes = place.planes,
                             .firstGroup = group,
                             .firstIndex = piece.firstIndex,
                             .halves = piece.source.shape().closed ? 2u : 1u,
                             .padding = 0};
        group += (piece.count + gpu::SILHOUETTE_GROUP - 1) / gpu::SILHOUETTE_GROUP;
    }
}

void writeMesh(const MeshPlace& place, std::span<std::uint32_t> words)
{
    const Topology& topology = *place.mesh->topology;
    std::uint32_t* edge = words.data() + place.edges;
    for (const Topology::Edge& from : topology.edges) {
        const std::uint32_t record[gpu::EDGE_WORDS] = {from.v0, from.v1, from.firstUse, from.useCount};
        edge = std::copy_n(record, gpu::EDGE_WORDS, edge);
    }
    std::uint32_t* use = words.data() + place.uses;
    for (const Topology::EdgeUse& from : topology.uses)
        *use++ = 2 * from.face + (from.sign > 0.0f ? 1 : 0);
    const std::size_t blocks = (topology.facePlanes.size() + kBlockFaces - 1) / kBlockFaces;
    std::memcpy(words.data() + place.planes, topology.facePlanes.blocks(), blocks * sizeof(FaceBlock));
}

void writeTopology(const Layout& layout, const HostContext& host)
{
    const std::span<std::uint32_t> words = host.write<std::uint32_t>(layout.topology);
    std::uint32_t* group = words.data();
    for (std::uint32_t i = 0; i < layout.records.size(); ++i)
        for (std::uint32_t edge = 0; edge < layout.records[i].edgeCount; edge += gpu::SILHOUETTE_GROUP)
            *group++ = i;
    std::memcpy(group, layout.records.data(), layout.records.size_bytes());
    for (const MeshPlace& place : layout.meshes)
        writeMesh(place, words);
}

void writeLights(const Layout& layout, const HostContext& host)
{
    const std::span<gpu::FaceLight> lights = host.write<gpu::FaceLight>(layout.lights);
    for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
        const VolumeSource& source = layout.pieces[i].source;
        lights[i] = lightInObjectSpace(*layout.light, *source.caster);
        lights[i].touched = touchedWay(source.shape().closed, source.caster->mirrored);
    }
}

std::uint64_t topologyStamp(const Layout& layout)
{
    Stamp stamp;
    for (std::size_t i = 0; i < layout.pieces.size(); ++i)
        stamp.add(layout.pieces[i].source.caster->mesh->revision)
            .add(std::uint64_t{layout.records[i].edges} << 32 | layout.records[i].firstIndex);
    return stamp.value();
}

/// Once, and again when a mesh or the choice of casters changes: how casters lie does not matter.
void declareTopology(PassBuilder& passes, Layout& layout, std::uint32_t variant)
{
    const KeptList list = passes.keptList(BufferInfo{.name = "volumes.topology",
                                                     .scope = Scope::light,
                                                     .size = VkDeviceSize{4} * layout.words,
                                                     .variant = variant},
                                          topologyStamp(layout));
    layout.topology = list.buffer;
    if (!list.due) return;
    const Layout* shared = &layout;
    passes.prepare("volumes.topology", Scope::light, variant).writes(layout.topology).run([shared](HostContext& host) {
        writeTopology(*shared, host);
    });
}

} // namespace

const char* refusesGpuSides(const DeviceTable& vk, const ShadowTask& task)
{
    if (const char* reason = refusesReadSides(vk, task)) return reason;
    for (const std::span<const Caster* const> casters : {task.casters->statics, task.casters->dynamics})
        if (!fitsBinding(vk, topologyBytes(casters)))
            return "the casters in range have more topology than a storage buffer holds";
    return nullptr;
}

GpuSilhouettes makeGpuSilhouettes(const AlgorithmServices& services)
{
    constexpr BindingInfo bindings[] = {{.binding = 0, .kind = BindingKind::storageBuffer},
                                        {.binding = 1, .kind = BindingKind::storageBuffer},
                                        {.binding = 2, .kind = BindingKind::storageBuffer}};
    return {.find = services.pipelines->compute({.name = "volumes.find_sides",
                                                 .compute = {.code = k_volumes_silhouettes_comp},
                                                 .bindings = bindings,
                                                 .pushBytes = sizeof(gpu::SilhouettePush)})};
}

BufferId declareGpuSides(PassBuilder& passes, const ShadowTask& task, const GpuSilhouettes& shader,
                         std::span<const VolumePiece> pieces, std::uint32_t size, std::uint32_t variant,
                         std::uint64_t stamp)
{
    const BufferId list = passes.persistent(BufferInfo{
        .name = "volumes.found_sides", .scope = Scope::light, .size = VkDeviceSize{4} * size, .variant = variant});
    if (!passes.stale(list, stamp)) {
        passes.kept();
        return list;
    }
    Layout& layout = *passes.arena().make<Layout>();
    layout.light = task.light;
    layOut(passes.arena(), pieces, layout);
    declareTopology(passes, layout, variant);
    layout.lights = passes.transient(BufferInfo{.name = "volumes.lights",
                                                .scope = Scope::light,
                                                .size = sizeof(gpu::FaceLight) * pieces.size(),
                                                .place = BufferPlace::upload,
                                                .variant = variant});
    const Layout* shared = &layout;
    passes.prepare("volumes.lights", Scope::light, variant).writes(layout.lights).run([shared](HostContext& host) {
        writeLights(*shared, host);
    });
    const VkDeviceSize commands = sizeof(VkDrawIndexedIndirectCommand) * pieces.size();
    passes.transfer("volumes.clear_sides", Scope::light, variant).writes(list).record([=](PassContext& context) {
        context.vk->vkCmdFillBuffer(context.cmd, context.buffer(list), 0, commands, 0);
    });
    passes.compute("volumes.find_sides", Scope::light, variant)
        .reads(layout.topology)
        .reads(layout.lights)
        .updates(list)
        .record([=, find = shader.find](PassContext& context) {
            context.bind(find, {context.storage(0, shared->topology), context.storage(1, shared->lights),
                                context.storage(2, list)});
            context.push(gpu::SilhouettePush{.groups = shared->groups, .firstPiece = shared->groups});
            const std::uint32_t rows = (shared->groups + kGroupsInRow - 1) / kGroupsInRow;
            context.vk->vkCmdDispatch(context.cmd, std::min(shared->groups, kGroupsInRow), rows, 1);
        });
    return list;
}

} // namespace gnomon
