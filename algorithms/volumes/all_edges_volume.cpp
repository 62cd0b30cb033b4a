#include "algorithms/volumes/all_edges_volume.hpp"

#include <algorithm>

#include "algorithms/shared/mesh_numbers.hpp"
#include "algorithms/volumes/edge_list.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/silhouette.hpp"
#include "algorithms/volumes/volume_count.hpp"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail };

constexpr VolumeCountNames kNames{
    .volumes = {.zPass = {"all_edges_volume.z_pass", "all_edges_volume.z_pass_reversed"},
                .zFail = {"all_edges_volume.z_fail", "all_edges_volume.z_fail_reversed"},
                .caps = {"all_edges_volume.caps", "all_edges_volume.caps_reversed"}},
    .resolve = {"all_edges_volume.dark", "all_edges_volume.counted", "all_edges_volume.uncounted"}};

// --- lists of meshes ---

BufferInfo listInfo(const MeshView& mesh)
{
    return {.name = "all_edges_volume.edges",
            .scope = Scope::scene,
            .size = edgeListSize(*mesh.topology).bytes(),
            .variant = mesh.id};
}

/// The list of the mesh: built when its positions are new, and kept whatever lights and casters do.
BufferId declareEdges(PassBuilder& passes, const MeshView& mesh)
{
    const auto [list, due] = passes.keptList(listInfo(mesh), mesh.revision);
    if (!due) {
        passes.kept();
        return list;
    }
    const Topology* topology = mesh.topology;
    passes.prepare("all_edges_volume.edges", Scope::scene, mesh.id)
        .writes(list)
        .run([topology, list = list](HostContext& host) {
            writeEdgeList(*topology, host.write<std::uint32_t>(list));
            host.countIndexList();
        });
    return list;
}

/// The lists of a task's meshes, each declared once.
class MeshLists {
public:
    MeshLists(PassBuilder& passes, std::size_t most)
        : passes_(passes), numbers_(passes.arena(), most), lists_(passes.arena().array<BufferId>(most))
    {
    }
    BufferId find(const MeshView& mesh)
    {
        const std::uint32_t known = numbers_.count(), number = numbers_.of(mesh);
        if (number == known) lists_[number] = declareEdges(passes_, mesh);
        return lists_[number];
    }
    std::span<const BufferId> all() const { return lists_.first(numbers_.count()); }

private:
    PassBuilder& passes_;
    MeshNumbers numbers_;
    std::span<BufferId> lists_;
};

// --- the method ---

VolumePlan* planEdges(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil)
{
    VolumePlan* plan = emptyPlan(passes, task, stencil, task.settings[kBounded] != 0.0);
    const bool zFailForAll = task.settings[kZFail] != 0.0;
    MeshLists lists(passes, task.casters->all.size());
    const auto seen = [&](const Aabb& box) { return shadowTouches(box, *task.light, task.view->frustum); };
    for (const std::span<const Caster* const> casters : {task.casters->statics, task.casters->dynamics}) {
        for (const VolumeSource& source : volumesOf(passes.arena(), casters, *task.light)) {
            VolumeDraw draw{.source = source, .bounds = source.bounds()};
            if (!seen(draw.bounds)) continue;
            const bool fails = zFailForAll || needsZFail(*plan, draw);
            if (fails) draw = asFailing(*plan, draw);
            draw.list = draw.commands = lists.find(*source.caster->mesh);
            const auto whole = static_cast<std::uint32_t>(source.caster->mesh->topology->clusters.size());
            const std::uint32_t cluster = std::min(source.cluster, whole);
            draw.firstCommand = commandOf(cluster, kPairCommand);
            draw.commandCount = source.shape().closed ? 1 : 2; // a closed cluster has no borders
            append(fails ? plan->zFail : plan->zPass, draw);
            draw.firstCommand = commandOf(cluster, kCapCommand);
            draw.commandCount = draw.times = 1;
            if (fails) append(plan->caps, draw);
        }
    }
    plan->meshLists = lists.all();
    return plan;
}

class AllEdgesVolume final : public ShadowAlgorithm {
public:
    explicit AllEdgesVolume(const AlgorithmServices& services)
        : vk_(*services.vk), pipelines_(makeVolumeCountPipelines(services, kNames, VolumeShape::allEdges)),
          view_(makeViewStencilPipelines(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const ViewStencil stencil = declareViewStencil(passes, view_, task);
        const VolumePlan* volumes = planEdges(passes, task, stencil);
        declareCount(passes, task, "all_edges_volume.count", stencil, *volumes, pipelines_);
    }
    const char* refuses(const ShadowTask& task) const override;

private:
    const DeviceTable& vk_;
    VolumeCountPipelines pipelines_;
    ViewStencilPipelines view_;
};

const char* AllEdgesVolume::refuses(const ShadowTask& task) const
{
    if (const char* reason = refusesVolumes(vk_, task)) return reason;
    const VkPhysicalDeviceLimits& limits = vk_.properties.limits;
    for (const Caster* caster : task.casters->all) {
        if (!castsVolume(*caster)) continue;
        const EdgeListSize size = edgeListSize(*caster->mesh->topology);
        if (size.largestIndex() > limits.maxDrawIndexedIndexValue || !fitsBinding(vk_, size.bytes()))
            return "a caster has more edges than the device can index";
    }
    return nullptr;
}

} // namespace

const AlgorithmEntry kAllEdgesVolume{
    .name = "all_edges_volume",
    .source = "Kolic, Mihajlovic and Budin 2004; Rautenbach 2008, 2.4",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = kSettings,
    // Lists belong to meshes, not to lights.
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent, GnLightType) { return viewStencilMemory(extent); },
    .missing = missingForStencil,
    .create = makeAlgorithm<AllEdgesVolume>,
    .typicalWrongPercent = 0.004f, // stencil_volume's picture
};

} // namespace gnomon
