#include "algorithms/volumes/mesh_volumes.hpp"

#include <algorithm>

#include "algorithms/shared/mesh_numbers.hpp"
#include "algorithms/volumes/mesh_planes.hpp"
#include "algorithms/volumes/silhouette.hpp"

#include "shaders/volumes/mesh_volume.h"
#include "shaders/volumes_mesh_caps_comp.h"
#include "shaders/volumes_mesh_sides_comp.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kEdgeWords = 4, kCommandWords = sizeof(VkDrawIndexedIndirectCommand) / 4;

PipelineId makeFind(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> code)
{
    return services.pipelines->compute(name, {code}, {bufferAt(0), bufferAt(1), bufferAt(2)},
                                       sizeof(gpu::MeshVolumePush));
}

VkDeviceSize edgeWords(const Topology& topology)
{
    return kEdgeWords * VkDeviceSize{topology.edges.size()} + topology.uses.size();
}

void writeEdges(const Topology& topology, std::span<std::uint32_t> words)
{
    const auto firstUse = static_cast<std::uint32_t>(kEdgeWords * topology.edges.size());
    std::uint32_t* next = words.data();
    for (const Topology::Edge& edge : topology.edges) {
        const std::uint32_t record[kEdgeWords] = {edge.v0, edge.v1, firstUse + edge.firstUse, edge.useCount};
        next = std::copy_n(record, kEdgeWords, next);
    }
    for (const Topology::EdgeUse& use : topology.uses)
        *next++ = 2 * use.face + (use.sign > 0.0f ? 1 : 0);
}

/// Edges of mesh_sides.comp: once for a connectivity, whatever lights and casters do, and poses where the GPU alone
/// knows them.
BufferId declareEdges(PassBuilder& passes, const MeshView& mesh)
{
    const Topology& topology = topologyOf(mesh);
    return declareMeshList(passes, mesh, "volumes.mesh_edges", 4 * edgeWords(topology),
                           [&topology](HostContext& host, BufferId list) {
                               writeEdges(topology, host.write<std::uint32_t>(list));
                               host.countIndexList();
                           });
}

/// What is read of a mesh.
struct MeshItems {
    BufferId items, planes; ///< Edges, or corners of faces.
};

/// Of one piece: what its dispatch is given.
struct Find {
    MeshItems mesh;
    gpu::MeshVolumePush push{};
};

gpu::MeshVolumePush pushOf(const LightView& light, const VolumePiece& piece)
{
    const Caster& caster = *piece.source.caster;
    const bool closed = piece.source.shape().closed;
    gpu::MeshVolumePush push{};
    push.light = lightInObjectSpace(light, caster);
    push.light.touched = touchedWay(closed, caster.mirrored);
    push.first = piece.first;
    push.count = piece.count;
    push.firstIndex = piece.firstIndex;
    push.halves = closed ? 2 : 1;
    const std::uint32_t away = caster.mirrored ? gpu::FACE_TOWARDS : gpu::FACE_AWAY;
    push.capsWay = closed && !piece.source.bothSides ? away : gpu::FACE_TOUCHED;
    return push;
}

void recordFinds(PassContext& gpu, std::span<const Find> finds, PipelineId pipeline, BufferId list)
{
    BufferId bound;
    for (const Find& find : finds) {
        if (find.mesh.items.index != bound.index)
            gpu.bind(pipeline,
                     {gpu.storage(0, find.mesh.items), gpu.storage(1, find.mesh.planes), gpu.storage(2, list)});
        bound = find.mesh.items;
        gpu.push(find.push);
        dispatchInRows(gpu, find.push.count, gpu::MESH_VOLUME_GROUP);
    }
}

} // namespace

MeshVolumePipelines makeMeshVolumePipelines(const AlgorithmServices& services)
{
    return {.planes = makeFindPlanes(services),
            .sides = makeFind(services, "volumes.mesh_sides", k_volumes_mesh_sides_comp),
            .caps = makeFind(services, "volumes.mesh_caps", k_volumes_mesh_caps_comp)};
}

BufferId declareFound(PassBuilder& passes, const LightView& light, const MeshVolumePipelines& pipelines, ListKind kind,
                      std::span<const VolumePiece> pieces, const BufferInfo& info, std::uint64_t stamp)
{
    const BufferId list = passes.persistent(info);
    if (!passes.stale(list, stamp)) {
        passes.kept();
        return list;
    }
    const bool sides = kind == ListKind::sides;
    MeshNumbers numbers(passes.arena(), pieces.size());
    const std::span<MeshItems> meshes = passes.arena().array<MeshItems>(pieces.size());
    const std::span<Find> finds = passes.arena().array<Find>(pieces.size());
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
        const MeshView& mesh = *pieces[i].source.caster->mesh;
        const std::uint32_t known = numbers.count(), number = numbers.of(mesh);
        if (number == known)
            meshes[number] = {.items = sides ? declareEdges(passes, mesh) : declareCorners(passes, mesh),
                              .planes = declarePlanes(passes, mesh, pipelines.planes)};
        finds[i] = {.mesh = meshes[number], .push = pushOf(light, pieces[i])};
        finds[i].push.command = kCommandWords * i;
    }
    const VkDeviceSize commands = 4 * kCommandWords * pieces.size();
    passes.transfer(sides ? "volumes.clear_mesh_sides" : "volumes.clear_mesh_caps", info.scope, info.variant)
        .writes(list)
        .record([=](PassContext& gpu) { gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(list), 0, commands, 0); });
    PassRef pass = passes.compute(info.name, info.scope, info.variant);
    for (const MeshItems& mesh : meshes.first(numbers.count()))
        pass.reads(mesh.items).reads(mesh.planes);
    pass.updates(list).record([=, pipeline = sides ? pipelines.sides : pipelines.caps](PassContext& gpu) {
        recordFinds(gpu, finds, pipeline, list);
    });
    return list;
}

const char* refusesMeshVolumes(const DeviceTable& vk, const ShadowTask& task, bool all)
{
    if (const char* reason = all ? refusesReadSides(vk, task) : nullptr) return reason;
    const std::span<const Caster* const> casters = task.casters->all;
    for (const Caster* caster : casters) {
        if (!castsByConnectivity(*caster) && !(all && castsVolume(*caster))) continue;
        if (caster->mesh->positionCount() > vk.properties.limits.maxDrawIndexedIndexValue / 2)
            return "a caster has more vertices than the device's index range";
        const Topology& topology = topologyOf(*caster->mesh);
        if (!fitsBinding(vk, 4 * edgeWords(topology)) || !fitsBinding(vk, planesBytes(topology)))
            return "a caster has more topology than a storage buffer holds";
    }
    return fitsBinding(vk, sidesBytes(casters, castsByConnectivity)) &&
                   fitsBinding(vk, capsBytes(casters, castsByConnectivity))
               ? nullptr
               : "the casters in range have more edges than a storage buffer holds";
}

} // namespace gnomon
