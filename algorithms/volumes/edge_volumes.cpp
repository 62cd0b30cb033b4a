#include "algorithms/volumes/edge_volumes.hpp"

#include <algorithm>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/mesh_numbers.hpp"
#include "algorithms/volumes/edge_list.hpp"
#include "algorithms/volumes/mesh_planes.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/silhouette.hpp"

namespace gnomon {

namespace {

/// The list of the mesh: built when its positions are new, and kept whatever lights and casters do. Where the GPU alone
/// knows the positions, built once for its connectivity.
BufferId declareEdges(PassBuilder& passes, const MeshView& mesh)
{
    const Topology& topology = topologyOf(mesh);
    return declareMeshList(passes, mesh, "volumes.edges", edgeListSize(topology).bytes(),
                           [&topology](HostContext& host, BufferId list) {
                               writeEdgeList(topology, host.write<std::uint32_t>(list));
                               host.countIndexList();
                           });
}

/// Of one mesh.
struct MeshList {
    BufferId edges, planes; ///< VolumeDraw::planes
    std::uint32_t firstPlane = 0;
};

/// The lists of a task's meshes, each declared once.
class MeshLists {
public:
    MeshLists(PassBuilder& passes, PipelineId findPlanes, std::size_t most)
        : passes_(passes), findPlanes_(findPlanes), numbers_(passes.arena(), most),
          lists_(passes.arena().array<MeshList>(most)), edges_(passes.arena().array<BufferId>(most)),
          planes_(passes.arena().array<BufferId>(most).first(0))
    {
    }
    const MeshList& find(const MeshView& mesh)
    {
        const std::uint32_t known = numbers_.count(), number = numbers_.of(mesh);
        if (number == known) add(mesh, number);
        return lists_[number];
    }
    std::span<const BufferId> all() const { return edges_.first(numbers_.count()); }
    std::span<const BufferId> planes() const { return planes_; }

private:
    void add(const MeshView& mesh, std::uint32_t number)
    {
        MeshList& list = lists_[number] = {};
        list.edges = edges_[number] = declareEdges(passes_, mesh);
        if (mesh.topology) return;
        const EdgeListSize size = edgeListSize(*mesh.connectivity);
        list.planes = declarePlanes(passes_, mesh, findPlanes_);
        list.firstPlane = static_cast<std::uint32_t>(size.firstSlot() + size.slots() - size.faces);
        planes_ = {planes_.data(), planes_.size() + 1};
        planes_.back() = list.planes;
    }

    PassBuilder& passes_;
    PipelineId findPlanes_;
    MeshNumbers numbers_;
    std::span<MeshList> lists_;
    std::span<BufferId> edges_, planes_;
};

/// The draws of one volume, if the view can see it.
void planVolume(const ShadowTask& task, const VolumeSource& source, bool zFailForAll, MeshLists& lists,
                VolumePlan& plan)
{
    VolumeDraw draw{.source = source, .bounds = source.bounds()};
    if (!shadowTouches(draw.bounds, *task.light, task.view->frustum)) return;
    const bool fails = zFailForAll || needsZFail(plan, draw);
    if (fails) draw = asFailing(plan, draw);
    const MeshList& list = lists.find(*source.caster->mesh);
    draw.list = draw.commands = list.edges;
    draw.planes = list.planes;
    draw.firstPlane = list.firstPlane;
    const auto whole = static_cast<std::uint32_t>(source.topology().clusters.size());
    const std::uint32_t cluster = std::min(source.cluster, whole);
    draw.firstCommand = commandOf(cluster, kPairCommand);
    draw.commandCount = source.shape().closed ? 1 : 2; // a closed cluster has no borders
    append(fails ? plan.zFail : plan.zPass, draw);
    draw.firstCommand = commandOf(cluster, kCapCommand);
    draw.commandCount = draw.times = 1;
    if (fails) append(plan.caps, draw);
}

} // namespace

VolumePlan* planEdgeVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                            PipelineId findPlanes, bool bounded, bool zFailForAll)
{
    VolumePlan* plan = emptyPlan(passes, task, stencil, bounded);
    MeshLists lists(passes, findPlanes, task.casters->all.size());
    for (const std::span<const Caster* const> casters : {task.casters->statics, task.casters->dynamics})
        for (const VolumeSource& source : volumesOf(passes.arena(), casters, *task.light))
            planVolume(task, source, zFailForAll, lists, *plan);
    // Bounds of clusters are of another pose: each of these is one volume.
    for (const Caster* caster : task.casters->all)
        if (castsByConnectivity(*caster)) planVolume(task, {caster, VolumeSource::kWhole}, zFailForAll, lists, *plan);
    plan->meshLists = lists.all();
    plan->planeLists = lists.planes();
    return plan;
}

const char* refusesEdgeVolumes(const DeviceTable& vk, const ShadowTask& task)
{
    if (const char* reason = refusesVolumes(vk, task)) return reason;
    const VkPhysicalDeviceLimits& limits = vk.properties.limits;
    for (const Caster* caster : task.casters->all) {
        if (!castsVolume(*caster) && !castsByConnectivity(*caster)) continue;
        const EdgeListSize size = edgeListSize(topologyOf(*caster->mesh));
        if (size.largestIndex() > limits.maxDrawIndexedIndexValue || !fitsBinding(vk, size.bytes()))
            return "a caster has more edges than the device can index";
    }
    return nullptr;
}

} // namespace gnomon
