// Stencil shadow volumes of lights and casters that stand still: built once, concealed ones left out, the rest kept in
// an octree and drawn only where the depth image says that they matter. The picture is stencil_volume's.
// Source:    Rautenbach, Pieterse and Kourie, in Rautenbach 2008, 3.3.4, 4.3.6 and 4.4. Umbrae of convex occluders:
//            Hudson et al. 1997; culling of volumes: Lloyd et al. 2004.
// Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes: visibility.
// Strong at: many static casters behind walls, and many lights of which each matters to a part of the view.
// Weak at:   what stencil_volume is weak at; lights that move get nothing but stencil_volume.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/static_volumes.hpp"
#include "algorithms/volumes/volume_count.hpp"
#include "algorithms/volumes/volume_cull.hpp"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
    {"conceal", "1: volumes inside another one are left out; 0: all static casters have theirs", 0, 1, 1},
    {"extents", "1: volumes are held against the extents of the depth image; 0: against the view frustum only", 0, 1,
     1},
};
enum Setting : std::size_t { kBounded, kZFail, kConceal, kExtents };

constexpr VolumeCountNames kNames{.volumes = {.zPass = "octree_volume.z_pass", .zFail = "octree_volume.z_fail"},
                                  .resolve = "octree_volume.resolve"};

// Regions of all static casters, and of chosen ones, beside stencil_volume's of static and of moving ones.
constexpr std::uint32_t kRegionsVariant = 2;

// Of caps that are counted with both sides; 0 and 1 tell whether volumes are concealed.
constexpr std::uint32_t kBothSidesVariant = 2;

class OctreeVolume final : public ShadowAlgorithm {
public:
    explicit OctreeVolume(const AlgorithmServices& services);
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override { return refusesVolumes(vk_, task); }

private:
    const DeviceTable& vk_;
    VolumeCountPipelines pipelines_;
    ViewStencilPipelines view_;
    VolumeCullPipelines cull_;
    StaticVolumesCache kept_;
};

OctreeVolume::OctreeVolume(const AlgorithmServices& services)
    : vk_(*services.vk), pipelines_(makeVolumeCountPipelines(services, kNames)),
      view_(makeViewStencilPipelines(services)), cull_(makeVolumeCullPipelines(services))
{
}

/// The light's kept volumes as they concern one view; in the frame's arena.
struct KeptDraws {
    const StaticVolumes* volumes = nullptr;
    VolumeChoice choice;
    VolumeList sides;
    std::span<const VolumeDraw> drawOf;  ///< Of the sides, by position in `drawn`.
    std::span<std::uint32_t> candidates; ///< Positions, front to back.
};

KeptDraws findDraws(PassBuilder& passes, const ShadowTask& task, std::span<const VolumeSource> all,
                    const StaticVolumes& volumes, std::uint32_t variant)
{
    KeptDraws kept{.volumes = &volumes};
    FrameArena& arena = passes.arena();
    const std::size_t count = volumes.drawn.size();
    const std::span<VolumeSource> sources = arena.array<VolumeSource>(count);
    for (std::size_t i = 0; i < count; ++i)
        sources[i] = all[volumes.drawn[i]];
    kept.choice = {.volumes = sources, .stamp = volumes.stamp, .variant = variant};
    kept.sides = declareChosenSides(passes, task, kept.choice);
    if (kept.sides.pieces.empty()) return kept; // it has failed: no list may be that long

    const std::span<VolumeDraw> draws = arena.array<VolumeDraw>(count);
    for (std::uint32_t piece = 0, i = 0; piece < kept.sides.pieces.size(); ++i)
        draws[i] = drawAt(kept.sides, piece);
    kept.drawOf = draws;

    kept.candidates = arena.array<std::uint32_t>(count);
    std::size_t found = 0;
    volumes.tree.visit(
        task.view->eye, [&](const Aabb& box) { return shadowTouches(box, *task.light, task.view->frustum); },
        [&](std::uint32_t position) { kept.candidates[found++] = position; });
    kept.candidates = kept.candidates.first(found);
    return kept;
}

/// The choice whose caps are kept. Where light or eye are within a closed cluster of an open mesh (asFailing()) all
/// such clusters count with both sides, from a list of its own: neither list depends on where the eye is.
VolumeChoice capsChoice(FrameArena& arena, const KeptDraws& kept, VolumePlan& plan)
{
    VolumeChoice choice = kept.choice;
    if (std::none_of(plan.zFail.begin(), plan.zFail.end(),
                     [&](const VolumeDraw& draw) { return asFailing(plan, draw).source.bothSides; }))
        return choice;
    for (VolumeDraw& draw : plan.zFail)
        draw.times = draw.source.closedInOpenMesh() ? 2 : 1;
    const std::span<VolumeSource> volumes = arena.array<VolumeSource>(choice.volumes.size());
    std::copy(choice.volumes.begin(), choice.volumes.end(), volumes.begin());
    for (VolumeSource& source : volumes)
        source.bothSides = source.closedInOpenMesh();
    choice.volumes = volumes;
    choice.variant += kBothSidesVariant;
    return choice;
}

/// Caps of the candidates that z-fail counts; the list is of all kept volumes, so that it is built once.
VolumeList addKeptCaps(PassBuilder& passes, const ShadowTask& task, VolumePlan& plan, const KeptDraws& kept)
{
    const VolumeList caps = declareChosenCaps(passes, task, capsChoice(passes.arena(), kept, plan));
    const std::span<VolumeDraw> draws = passes.arena().array<VolumeDraw>(kept.drawOf.size());
    for (std::uint32_t piece = 0, i = 0; piece < caps.pieces.size(); ++i)
        draws[i] = drawAt(caps, piece);
    std::size_t failing = 0;
    for (const std::uint32_t position : kept.candidates) {
        if (failing == plan.zFail.size()) break;
        if (plan.zFail[failing].source != kept.drawOf[position].source) continue;
        append(plan.caps, draws[position]);
        ++failing;
    }
    return caps;
}

/// The static casters' part of the plan.
void planStatics(PassBuilder& passes, const ShadowTask& task, const KeptDraws& kept, VolumePlan& plan)
{
    for (const std::uint32_t position : kept.candidates) {
        const VolumeDraw& draw = kept.drawOf[position];
        const bool fails = task.settings[kZFail] != 0.0 || needsZFail(plan, draw);
        append(fails ? plan.zFail : plan.zPass, draw);
    }
    plan.lists[0] = kept.sides;
    if (!plan.zFail.empty()) plan.lists[2] = addKeptCaps(passes, task, plan, kept);
}

void OctreeVolume::declare(PassBuilder& passes, const ShadowTask& task)
{
    const bool bounded = task.settings[kBounded] != 0.0, zFailForAll = task.settings[kZFail] != 0.0;
    const ViewStencil stencil = declareViewStencil(passes, view_, task);
    // What moves with the light is new in every frame: there is nothing to keep, and nothing is looked for.
    if (!task.light->isStatic) {
        const VolumePlan* plan = planVolumes(passes, task, stencil, bounded, zFailForAll);
        declareCount(passes, task, "octree_volume.count", stencil, *plan, pipelines_);
        return;
    }
    const bool conceal = task.settings[kConceal] != 0.0;
    const std::span<const VolumeSource> all = volumesOf(passes.arena(), task.casters->statics, *task.light);
    const StaticVolumes& volumes = kept_.find(*task.light, all, conceal);
    const KeptDraws kept = findDraws(passes, task, all, volumes, conceal ? 1 : 0);
    VolumePlan* plan = emptyPlan(passes, task, stencil, bounded);
    planStatics(passes, task, kept, *plan);

    const std::size_t firstMoving = plan->zFail.size();
    plan->lists[1] = declareSides(passes, task, false);
    addSides(*plan, plan->lists[1], zFailForAll);
    plan->lists[3] = addCaps(passes, task, *plan, firstMoving, 1);
    if (task.settings[kExtents] != 0.0 && canReadLists(vk_, task)) {
        const CulledList statics{.index = 0,
                                 .stamp = volumes.stamp,
                                 .variant = kRegionsVariant + kept.choice.variant,
                                 .occluders = volumes.occluders};
        declareCull(passes, cull_, task, stencil, {&statics, 1}, *plan);
    }
    declareCount(passes, task, "octree_volume.count", stencil, *plan, pipelines_);
}

VkDeviceSize memoryPerLight(std::span<const double>, VkExtent2D extent, GnLightType)
{
    return viewStencilMemory(extent) + cullMemory(extent);
}

} // namespace

const AlgorithmEntry kOctreeVolume{
    .name = "octree_volume",
    .source = "Rautenbach 2008, 3.3.4 and 4.3.6",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .missing = missingForStencil,
    .create = makeAlgorithm<OctreeVolume>,
    .typicalWrongPercent = 0.004f, // an upper bound of docs/benchmarks-2026-11.md
};

} // namespace gnomon
