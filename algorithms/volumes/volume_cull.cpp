#include "algorithms/volumes/volume_cull.hpp"

#include <algorithm>
#include <cmath>

#include "shaders/volumes/cull.h"
#include "shaders/volumes_cull_volumes_comp.h"
#include "shaders/volumes_reached_tiles_comp.h"

namespace gnomon {

namespace {

static_assert(sizeof(gpu::KeptVolume::shadow) / sizeof(glm::vec4) == gpu::SHADOW_PLANES);
static_assert(sizeof(gpu::KeptUmbra::planes) / sizeof(glm::vec4) == gpu::UMBRA_PLANES);
static_assert(sizeof(gpu::CullConstants::candidates) / 4 == gpu::CANDIDATES);

// Head of the list of reached boxes: count and needed umbrae.
constexpr VkDeviceSize kReachedHead = 16;

constexpr BindingInfo kBindings[] = {
    {.binding = 0, .kind = BindingKind::constants},     {.binding = 1, .kind = BindingKind::storageBuffer},
    {.binding = 2, .kind = BindingKind::storageBuffer}, {.binding = 3, .kind = BindingKind::storageBuffer},
    {.binding = 4, .kind = BindingKind::storageBuffer}, {.binding = 5, .kind = BindingKind::storageBuffer},
    {.binding = 6, .kind = BindingKind::storageBuffer}};

PipelineId makeCompute(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> code,
                       std::size_t bindings)
{
    return services.pipelines->compute(
        {.name = name, .compute = {.code = code}, .bindings = std::span(kBindings).first(bindings)});
}

std::uint32_t groups(std::size_t invocations)
{
    return static_cast<std::uint32_t>((invocations + gpu::CULL_GROUP - 1) / gpu::CULL_GROUP);
}

std::uint32_t tileCount(const VkRect2D& area)
{
    const VkExtent2D tiles = tileExtent(area);
    return tiles.width * tiles.height;
}

VkDeviceSize reachedSize(std::uint32_t tiles)
{
    return kReachedHead + VkDeviceSize{sizeof(gpu::ReachedBox)} * tiles;
}

// --- what is kept ---

/// Commands of each caster in a list; the casters are those of StaticVolumes::drawn.
struct CommandRun {
    std::uint32_t first = 0, count = 0;
};

std::span<CommandRun> commandRuns(FrameArena& arena, const VolumeList& list, std::size_t casters)
{
    const std::span<CommandRun> runs = arena.array<CommandRun>(casters);
    std::fill(runs.begin(), runs.end(), CommandRun{});
    std::size_t caster = 0;
    for (std::uint32_t piece = 0; piece < list.pieces.size(); ++piece) {
        if (piece > 0 && list.pieces[piece].caster != list.pieces[piece - 1].caster) ++caster;
        if (runs[caster].count++ == 0) runs[caster].first = piece;
    }
    return runs;
}

struct KeptBuild {
    const StaticVolumes* volumes = nullptr;
    std::span<const CommandRun> sides, caps;
    BufferId buffer;
};

constexpr VkDeviceSize kUmbraeSize = VkDeviceSize{sizeof(gpu::KeptUmbra)} * gpu::UMBRAE;

void writeKept(const KeptBuild& build, HostContext& host)
{
    const StaticVolumes& from = *build.volumes;
    const std::span<gpu::KeptUmbra> umbrae = host.write<gpu::KeptUmbra>(build.buffer).first(gpu::UMBRAE);
    for (std::size_t i = 0; i < from.occluders.size(); ++i) {
        std::fill_n(umbrae[i].planes, gpu::UMBRA_PLANES, gpu::nowhereOutside());
        std::copy(from.occluders[i].umbra.planes.begin(), from.occluders[i].umbra.planes.end(), umbrae[i].planes);
    }
    const std::span<std::byte> bytes = host.write<std::byte>(build.buffer).subspan(kUmbraeSize);
    const std::span<gpu::KeptVolume> volumes(reinterpret_cast<gpu::KeptVolume*>(bytes.data()), from.drawn.size());
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        gpu::KeptVolume volume{};
        std::copy_n(from.shadows[i].planes, gpu::SHADOW_PLANES, volume.shadow);
        volume.firstSide = build.sides[i].first;
        volume.sideCount = build.sides[i].count;
        volume.firstCap = build.caps[i].first;
        volume.capCount = build.caps[i].count;
        volume.umbra = gpu::NO_UMBRA;
        volumes[i] = volume;
    }
    for (std::size_t i = 0; i < from.occluders.size(); ++i)
        volumes[from.occluders[i].position].umbra = static_cast<std::uint32_t>(i);
}

BufferId declareKept(PassBuilder& passes, const VolumeCull& cull)
{
    const std::uint32_t variant = 2 * cull.variant + (cull.caps.buffer ? 1 : 0);
    const std::size_t count = cull.volumes->drawn.size();
    const BufferId buffer = passes.persistent(BufferInfo{.name = "octree_volume.regions",
                                                         .scope = Scope::light,
                                                         .size = kUmbraeSize + sizeof(gpu::KeptVolume) * count,
                                                         .place = BufferPlace::upload,
                                                         .variant = variant});
    if (!passes.stale(buffer, cull.volumes->stamp)) {
        passes.kept();
        return buffer;
    }
    KeptBuild* build = passes.arena().make<KeptBuild>();
    build->volumes = cull.volumes;
    build->sides = commandRuns(passes.arena(), cull.sides, count);
    build->caps = commandRuns(passes.arena(), cull.caps, count);
    build->buffer = buffer;
    passes.prepare("octree_volume.regions", Scope::light, variant).writes(buffer).run([build](HostContext& host) {
        writeKept(*build, host);
    });
    return buffer;
}

// --- every frame ---

/// Umbrae are of use while nobody can look out of the caster's inside.
std::uint32_t usableUmbrae(const StaticVolumes& volumes, const CameraView& view)
{
    Aabb near{view.eye, view.eye};
    for (const glm::vec3& corner : view.nearCorners)
        near = {glm::min(near.lower, corner), glm::max(near.upper, corner)};
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < volumes.occluders.size(); ++i) {
        const Aabb& box = volumes.occluders[i].bounds;
        const bool apart = glm::any(glm::greaterThan(near.lower, box.upper + kUmbraMargin)) ||
                           glm::any(glm::lessThan(near.upper, box.lower - kUmbraMargin));
        if (apart) mask |= 1u << i;
    }
    return mask;
}

gpu::ReachConstants reachConstants(const ShadowTask& task, const StaticVolumes& volumes)
{
    const LightView& light = *task.light;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const bool cone = light.type == GN_LIGHT_TYPE_SPOT;
    gpu::ReachConstants block{};
    block.eyeWs = glm::vec4(task.view->eye, 0.0f);
    block.lightWs = glm::vec4(directional ? light.direction() : light.position(), directional ? 0.0f : 1.0f);
    block.axis = glm::vec4(light.direction(), cone ? std::cos(light.coneAngle) : -1.0f);
    block.sine = cone ? std::sin(light.coneAngle) : 0.0f;
    // Squared in the shader; whatever is beyond the root of the largest float has no end.
    block.range = std::min(light.constants.range, 1e18f);
    block.tileCount = tileCount(task.view->area);
    block.umbraMask = usableUmbrae(volumes, *task.view);
    return block;
}

BufferId declareReached(PassBuilder& passes, PipelineId pipeline, const ShadowTask& task, const StaticVolumes& volumes,
                        BufferId tiles, BufferId kept)
{
    gpu::ReachConstants* block = passes.arena().make<gpu::ReachConstants>();
    *block = reachConstants(task, volumes);
    const BufferId reached =
        passes.transient(BufferInfo{.name = "octree_volume.reached", .size = reachedSize(block->tileCount)});
    passes.transfer("octree_volume.clear").writes(reached).record([=](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(reached), 0, kReachedHead, 0);
    });
    passes.compute("octree_volume.reached").reads(tiles).reads(kept).updates(reached).record([=](PassContext& gpu) {
        gpu.bind(pipeline,
                 {gpu.constants(0, *block), gpu.storage(1, tiles), gpu.storage(2, kept), gpu.storage(3, reached)});
        gpu.vk->vkCmdDispatch(gpu.cmd, groups(block->tileCount), 1, 1);
    });
    return reached;
}

BufferId commandsOf(PassBuilder& passes, const char* name, const VolumeList& list)
{
    if (!list.buffer) return {};
    return passes.transient(
        BufferInfo{.name = name, .size = VkDeviceSize{sizeof(VkDrawIndexedIndirectCommand)} * list.pieces.size()});
}

} // namespace

VolumeCullPipelines makeVolumeCullPipelines(const AlgorithmServices& services)
{
    return {.reached = makeCompute(services, "octree_volume.reached", k_volumes_reached_tiles_comp, 4),
            .cull = makeCompute(services, "octree_volume.cull", k_volumes_cull_volumes_comp, 7)};
}

CulledCommands declareCull(PassBuilder& passes, const VolumeCullPipelines& pipelines, const ShadowTask& task,
                           const ViewStencil& stencil, const VolumeCull& cull)
{
    const BufferId kept = declareKept(passes, cull);
    const BufferId reached = declareReached(passes, pipelines.reached, task, *cull.volumes, stencil.tiles, kept);
    const CulledCommands commands{.sides = commandsOf(passes, "octree_volume.sides", cull.sides),
                                  .caps = commandsOf(passes, "octree_volume.caps", cull.caps)};

    PassRef pass = passes.compute("octree_volume.cull");
    pass.reads(kept).reads(reached).reads(cull.sides.buffer).writes(commands.sides);
    if (commands.caps) pass.reads(cull.caps.buffer).writes(commands.caps);
    const BufferId sides = cull.sides.buffer, caps = commands.caps ? cull.caps.buffer : sides;
    const BufferId keptCaps = commands.caps ? commands.caps : commands.sides;
    pass.record([=, candidates = cull.candidates, cullPipeline = pipelines.cull](PassContext& gpu) {
        for (std::size_t first = 0; first < candidates.size(); first += gpu::CANDIDATES) {
            const std::size_t count = std::min<std::size_t>(gpu::CANDIDATES, candidates.size() - first);
            gpu::CullConstants block;
            block.counts = {count, commands.caps ? 1 : 0, 0, 0};
            std::copy_n(candidates.data() + first, count, &block.candidates[0].x);
            gpu.bind(cullPipeline,
                     {gpu.constants(0, block), gpu.storage(1, kept), gpu.storage(2, reached), gpu.storage(3, sides),
                      gpu.storage(4, caps), gpu.storage(5, commands.sides), gpu.storage(6, keptCaps)});
            gpu.vk->vkCmdDispatch(gpu.cmd, static_cast<std::uint32_t>(count), 1, 1);
        }
    });
    return commands;
}

VkDeviceSize cullMemory(VkExtent2D extent)
{
    return pooledSize(reachedSize(tileCount({{0, 0}, extent})));
}

} // namespace gnomon
