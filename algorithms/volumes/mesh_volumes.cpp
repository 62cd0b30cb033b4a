#include "algorithms/volumes/mesh_volumes.hpp"

#include <algorithm>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/volumes/mesh_planes.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/silhouette.hpp"

#include "shaders/volumes/mesh_volume.h"
#include "shaders/volumes_mesh_caps_comp.h"
#include "shaders/volumes_mesh_sides_comp.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kEdgeWords = 4, kCommandWords = sizeof(VkDrawIndexedIndirectCommand) / 4;

PipelineId makeFind(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> code)
{
    constexpr BindingInfo bindings[] = {{.binding = 0, .kind = BindingKind::storageBuffer},
                                        {.binding = 1, .kind = BindingKind::storageBuffer},
                                        {.binding = 2, .kind = BindingKind::storageBuffer}};
    return services.pipelines->compute(
        {.name = name, .compute = {.code = code}, .bindings = bindings, .pushBytes = sizeof(gpu::MeshVolumePush)});
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

/// Edges of mesh_sides.comp: once for a connectivity, whatever lights, casters and poses do.
BufferId declareEdges(PassBuilder& passes, const MeshView& mesh)
{
    const Topology* topology = mesh.connectivity;
    const auto [list, due] = passes.keptList(
        {.name = "volumes.mesh_edges", .scope = Scope::scene, .size = 4 * edgeWords(*topology), .variant = mesh.id},
        mesh.connectivityRevision);
    if (!due) {
        passes.kept();
        return list;
    }
    passes.prepare("volumes.mesh_edges", Scope::scene, mesh.id)
        .writes(list)
        .run([topology, list = list](HostContext& host) {
            writeEdges(*topology, host.write<std::uint32_t>(list));
            host.countIndexList();
        });
    return list;
}

enum class Kind : std::uint8_t { sides, caps };

std::uint32_t itemsOf(const Topology& topology, Kind kind)
{
    return kind == Kind::sides ? topology.whole.edgeCount : topology.whole.faceCount;
}

std::uint32_t capacityOf(const Topology& topology, Kind kind)
{
    const std::uint32_t items = itemsOf(topology, kind);
    return kind == Kind::sides ? sideCapacity(topology, topology.whole, 0, items) : capCapacity(items);
}

/// Of one caster: what its dispatch is given.
struct Find {
    BufferId items, planes;
    gpu::MeshVolumePush push{};
};

gpu::MeshVolumePush pushOf(const LightView& light, const VolumeSource& volume, Kind kind)
{
    const Caster& caster = *volume.caster;
    const bool closed = volume.shape().closed;
    gpu::MeshVolumePush push{};
    push.light = lightInObjectSpace(light, caster);
    push.light.touched = touchedWay(closed, caster.mirrored);
    push.count = itemsOf(volume.topology(), kind);
    push.halves = closed ? 2 : 1;
    const std::uint32_t away = caster.mirrored ? gpu::FACE_TOWARDS : gpu::FACE_AWAY;
    push.capsWay = closed && !volume.bothSides ? away : gpu::FACE_TOUCHED;
    return push;
}

/// Words of the list of these volumes. Fits in 32 bits: refusesMeshVolumes().
VkDeviceSize listWords(std::span<const VolumeSource> volumes, Kind kind)
{
    VkDeviceSize words = kCommandWords * volumes.size();
    for (const VolumeSource& volume : volumes)
        words += capacityOf(volume.topology(), kind);
    return words;
}

std::uint64_t stampOf(const LightView& light, std::span<const VolumeSource> volumes)
{
    Stamp stamp;
    stamp.add(light.revision);
    for (const VolumeSource& volume : volumes)
        stamp.add(*volume.caster).add(std::uint64_t{volume.bothSides ? 1u : 0u});
    return stamp.value();
}

/// A list of sides or caps, a command for each volume; made again when the light or one of the casters has changed.
BufferId declareList(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& pipelines, Kind kind,
                     std::span<const VolumeSource> volumes)
{
    const bool sides = kind == Kind::sides;
    const Scope scope = sides ? Scope::light : Scope::task;
    const BufferId list = passes.persistent(BufferInfo{.name = sides ? "volumes.mesh_sides" : "volumes.mesh_caps",
                                                       .scope = scope,
                                                       .size = 4 * listWords(volumes, kind)});
    if (!passes.stale(list, stampOf(*task.light, volumes))) {
        passes.kept();
        return list;
    }
    const std::span<Find> finds = passes.arena().array<Find>(volumes.size());
    auto next = static_cast<std::uint32_t>(kCommandWords * volumes.size());
    for (std::uint32_t i = 0; i < volumes.size(); ++i) {
        const MeshView& mesh = *volumes[i].caster->mesh;
        finds[i] = {.items = sides ? declareEdges(passes, mesh) : declareCorners(passes, mesh),
                    .planes = declarePlanes(passes, mesh, pipelines.planes),
                    .push = pushOf(*task.light, volumes[i], kind)};
        finds[i].push.command = kCommandWords * i;
        finds[i].push.firstIndex = next;
        next += capacityOf(volumes[i].topology(), kind);
    }
    const VkDeviceSize commands = 4 * kCommandWords * volumes.size();
    passes.transfer(sides ? "volumes.clear_mesh_sides" : "volumes.clear_mesh_caps", scope)
        .writes(list)
        .record([=](PassContext& gpu) { gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(list), 0, commands, 0); });
    PassRef pass = passes.compute(sides ? "volumes.mesh_sides" : "volumes.mesh_caps", scope);
    for (const Find& find : finds)
        pass.reads(find.items).reads(find.planes);
    pass.updates(list).record([=, pipeline = sides ? pipelines.sides : pipelines.caps](PassContext& gpu) {
        for (const Find& find : finds) {
            if (find.push.count == 0) continue;           // a mesh of nothing but points and lines
            constexpr std::uint32_t kGroupsInRow = 65535; // Vulkan promises no more
            const std::uint32_t groups = (find.push.count + gpu::MESH_VOLUME_GROUP - 1) / gpu::MESH_VOLUME_GROUP;
            const std::uint32_t across = std::min(groups, kGroupsInRow);
            gpu.bind(pipeline, {gpu.storage(0, find.items), gpu.storage(1, find.planes), gpu.storage(2, list)});
            gpu.push(find.push);
            gpu.vk->vkCmdDispatch(gpu.cmd, across, (groups + across - 1) / across, 1);
        }
    });
    return list;
}

/// All casters of that kind, each as a whole.
std::span<const VolumeSource> volumesOf(FrameArena& arena, const ShadowTask& task)
{
    const std::span<VolumeSource> volumes = arena.array<VolumeSource>(task.casters->all.size());
    std::size_t count = 0;
    for (const Caster* caster : task.casters->all)
        if (castsByConnectivity(*caster)) volumes[count++] = {caster, VolumeSource::kWhole};
    return volumes.first(count);
}

} // namespace

MeshVolumePipelines makeMeshVolumePipelines(const AlgorithmServices& services)
{
    return {.planes = makeFindPlanes(services),
            .sides = makeFind(services, "volumes.mesh_sides", k_volumes_mesh_sides_comp),
            .caps = makeFind(services, "volumes.mesh_caps", k_volumes_mesh_caps_comp)};
}

void addMeshVolumes(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& pipelines, bool zFailForAll,
                    VolumePlan& plan)
{
    const std::span<const VolumeSource> volumes = volumesOf(passes.arena(), task);
    if (volumes.empty()) return;
    const BufferId sides = declareList(passes, task, pipelines, Kind::sides, volumes);
    const std::span<VolumeSource> failing = passes.arena().array<VolumeSource>(volumes.size());
    std::uint32_t failed = 0;
    for (std::uint32_t i = 0; i < volumes.size(); ++i) {
        VolumeDraw draw{.source = volumes[i],
                        .bounds = volumes[i].bounds(),
                        .list = sides,
                        .commands = sides,
                        .firstCommand = i,
                        .commandCount = 1};
        if (!shadowTouches(draw.bounds, *plan.light, plan.view->frustum)) continue;
        if (!zFailForAll && !needsZFail(plan, draw)) {
            append(plan.zPass, draw);
            continue;
        }
        draw = asFailing(plan, draw);
        append(plan.zFail, draw);
        failing[failed++] = draw.source;
    }
    plan.lists[4].buffer = sides;
    if (failed == 0) return;
    const BufferId caps = declareList(passes, task, pipelines, Kind::caps, failing.first(failed));
    for (std::uint32_t i = 0; i < failed; ++i)
        append(plan.caps, {.source = failing[i],
                           .bounds = failing[i].bounds(),
                           .list = caps,
                           .commands = caps,
                           .firstCommand = i,
                           .commandCount = 1});
    plan.lists[5].buffer = caps;
}

const char* refusesMeshVolumes(const DeviceTable& vk, const ShadowTask& task)
{
    VkDeviceSize sides = 0, caps = 0;
    for (const Caster* caster : task.casters->all) {
        if (!castsByConnectivity(*caster)) continue;
        const Topology& topology = *caster->mesh->connectivity;
        if (caster->mesh->positionCount() > vk.properties.limits.maxDrawIndexedIndexValue / 2)
            return "a caster has more vertices than the device's index range";
        if (!fitsBinding(vk, 4 * edgeWords(topology))) return "a caster has more topology than a storage buffer holds";
        sides += kCommandWords + VkDeviceSize{capacityOf(topology, Kind::sides)};
        caps += kCommandWords + VkDeviceSize{capacityOf(topology, Kind::caps)};
    }
    return fitsBinding(vk, 4 * sides) && fitsBinding(vk, 4 * caps)
               ? nullptr
               : "the casters in range have more edges than a storage buffer holds";
}

} // namespace gnomon
